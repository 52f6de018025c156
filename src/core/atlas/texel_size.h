#pragma once

#include <vector>

#include "core/atlas/atlas.h"
#include "core/base/median.h"

namespace phat {

/// Half of the charts' texels are no larger; 0 without charts.
inline float medianTexelSizeMeters(const Atlas& atlas) {
    std::vector<std::pair<double, uint64_t>> sizes;  // and tiles
    for (const Chart& chart : atlas.charts)
        sizes.emplace_back(chart.texelSizeMeters, uint64_t(chart.sizeTiles.x) * chart.sizeTiles.y);
    return float(weightedMedianOf(std::move(sizes)));
}

}  // namespace phat
