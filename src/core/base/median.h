#pragma once

#include <algorithm>
#include <vector>

namespace phat {

/// The upper one of an even number of values. pre: not empty.
inline double medianOf(std::vector<double> values) {
    const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

}  // namespace phat
