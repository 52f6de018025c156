#pragma once

#include <algorithm>
#include <utility>
#include <vector>

namespace phat {

/// The upper one of an even number of values. pre: not empty.
inline double medianOf(std::vector<double> values) {
    const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

/// The least value that half of the weight is at or below; 0 without values.
template <typename Weight>
double weightedMedianOf(std::vector<std::pair<double, Weight>> valuesAndWeights) {
    Weight total = 0, below = 0;
    for (const auto& [value, weight] : valuesAndWeights) total += weight;
    std::sort(valuesAndWeights.begin(), valuesAndWeights.end());
    for (const auto& [value, weight] : valuesAndWeights) {
        below += weight;
        if (2 * below >= total) return value;
    }
    return 0;
}

}  // namespace phat
