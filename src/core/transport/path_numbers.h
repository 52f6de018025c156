#pragma once
// The random numbers of one path, in sets of four.

#include <cassert>

#include "core/base/random.h"
#include "core/base/sobol.h"

namespace phat {

/// Sets are independent of each other; within a set, the paths of one seed are stratified together, as far as
/// they are a run 0, 1, ... n - 1 of indices. The n-th set of each path must serve the same purpose.
class PathNumbers {
  public:
    /// Numbers independent of those of other paths.
    explicit PathNumbers(Rng rng) : rng_(rng) {}
    /// pre: index < kMaxShuffled.
    PathNumbers(uint64_t seed, uint32_t index)
        : rng_(hashOf(seed, index)), seed_(seed), index_(index), stratifiedSets_(kStratifiedSets) {
        assert(index < kMaxShuffled);
    }

    /// The next set, in [0, 1).
    glm::vec4 next4() {
        // A seed of shuffledSobol4 is three steps of a sequence; the next set's are the next three.
        if (set_ < stratifiedSets_) return shuffledSobol4(index_, seed_ + 3 * kSeedStep * uint64_t(set_++));
        const glm::vec2 first = rng_.uniform2();
        return {first, rng_.uniform2()};
    }

  private:
    // The pixel and two sets at each of four reflections; later ones bring too little light to be worth it.
    static constexpr int kStratifiedSets = 9;

    Rng rng_;
    uint64_t seed_ = 0;
    uint32_t index_ = 0;
    int set_ = 0, stratifiedSets_ = 0;
};

}  // namespace phat
