#pragma once
// Pearson's test of counts against what a density predicts.

#include <cmath>
#include <span>

namespace phat::test {

struct ChiSquared {
    double value = 0;
    double limit = 0;  // exceeded by a correct sampler once in 10,000 seeds
    int degreesOfFreedom = 0;
};

/// Bins that expect fewer than five are pooled into one, as the approximation asks.
/// pre: the expected counts sum to the number of samples.
inline ChiSquared chiSquared(std::span<const double> counts, std::span<const double> expected) {
    ChiSquared test;
    double pooledCount = 0, pooledExpected = 0;
    int bins = 0;
    const auto add = [&](double count, double expectation) {
        test.value += (count - expectation) * (count - expectation) / expectation;
        ++bins;
    };
    for (size_t i = 0; i < counts.size(); ++i) {
        if (expected[i] >= 5) {
            add(counts[i], expected[i]);
        } else {
            pooledCount += counts[i];
            pooledExpected += expected[i];
        }
    }
    // Hits where next to nothing may be found must count against the sampler.
    if (pooledExpected >= 5 || pooledCount > 0) add(pooledCount, std::max(pooledExpected, 1e-3));
    test.degreesOfFreedom = bins - 1;
    // source: Wilson and Hilferty 1931. 3.719: one-sided 1e-4 of the normal distribution.
    const double n = test.degreesOfFreedom, spread = 2.0 / (9.0 * n);
    test.limit = n * std::pow(1.0 - spread + 3.719 * std::sqrt(spread), 3);
    return test;
}

}  // namespace phat::test
