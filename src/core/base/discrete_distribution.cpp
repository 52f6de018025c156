#include "core/base/discrete_distribution.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace phat {

DiscreteDistribution::DiscreteDistribution(std::span<const double> weights) {
    cumulative_.reserve(weights.size() + 1);
    cumulative_.push_back(0.0);
    for (double weight : weights) {
        assert(weight >= 0.0 && std::isfinite(weight));
        cumulative_.push_back(cumulative_.back() + weight);
    }
}

DiscreteDistribution::Choice DiscreteDistribution::choose(double unit, size_t first, size_t end) const {
    const double low = cumulative_[first], high = cumulative_[end];
    assert(high > low);
    const double target = low + unit * (high - low);
    // The first entry that ends beyond the target. Rounding may put the target on the very end: then the last
    // entry with a weight is meant, which is the one that first reaches the end.
    const auto begin = cumulative_.begin() + ptrdiff_t(first) + 1,
               last = cumulative_.begin() + ptrdiff_t(end) + 1;
    auto upper = std::upper_bound(begin, last, target);
    if (upper == last) upper = std::lower_bound(begin, last, high);
    const size_t index = size_t(upper - cumulative_.begin()) - 1;
    return {index, std::clamp((target - cumulative_[index]) / weight(index), 0.0, 1.0)};
}

}  // namespace phat
