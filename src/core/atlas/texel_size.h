#pragma once

#include <algorithm>
#include <vector>

#include "core/atlas/atlas.h"

namespace phat {

/// Half of the charts' texels are no larger; 0 without charts.
inline float medianTexelSizeMeters(const Atlas& atlas) {
    std::vector<std::pair<float, uint64_t>> sizes;
    uint64_t total = 0;
    for (const Chart& chart : atlas.charts) {
        const uint64_t tiles = uint64_t(chart.sizeTiles.x) * chart.sizeTiles.y;
        sizes.emplace_back(chart.texelSizeMeters, tiles);
        total += tiles;
    }
    std::sort(sizes.begin(), sizes.end());
    uint64_t sum = 0;
    for (const auto& [size, tiles] : sizes) {
        sum += tiles;
        if (2 * sum >= total) return size;
    }
    return 0;
}

}  // namespace phat
