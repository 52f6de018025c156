#pragma once
// Choice of one of many things in proportion to a weight.

#include <cstdint>
#include <span>
#include <vector>

namespace phat {

/// Cumulated weights in double: 100,000 entries of very different weight keep their probabilities.
class DiscreteDistribution {
  public:
    DiscreteDistribution() : cumulative_{0.0} {}
    /// pre: every weight is finite and >= 0.
    explicit DiscreteDistribution(std::span<const double> weights);

    size_t size() const { return cumulative_.size() - 1; }
    double total() const { return cumulative_.back(); }
    /// Weight of all entries before `index`, 0 to total().
    double cumulated(size_t index) const { return cumulative_[index]; }
    double weight(size_t index) const { return cumulative_[index + 1] - cumulative_[index]; }
    double probability(size_t index) const { return weight(index) / total(); }

    struct Choice {
        size_t index = 0;
        double within = 0;  // where in the entry's own interval the choice fell, [0,1]
    };
    /// Inverse of the cumulated weights, within entries [first, end). Never an entry of weight 0.
    /// pre: unit in [0,1), the entries' weights do not sum to 0.
    Choice choose(double unit, size_t first, size_t end) const;
    Choice choose(double unit) const { return choose(unit, 0, size()); }

  private:
    std::vector<double> cumulative_;  // size() + 1 entries, the first 0
};

}  // namespace phat
