#pragma once
// What the writer and the reader of baked files agree on. docs/format.md says what each of these means.

#include <bit>
#include <cstdint>

#include "core/atlas.h"

namespace phat {

inline constexpr uint64_t kBakedFormatVersion = 2;
// A chart owns tiles, and 16 bits count those of a side with room to spare.
inline constexpr uint64_t kMaxAtlasSide = 1 << 16;
inline constexpr uint64_t kMaxEnvironmentSide = 1 << 15;

/// A row of the chart table.
struct ChartRecord {
    uint32_t originTileX, originTileY, sizeTilesX, sizeTilesY;
    uint32_t surface;
    uint32_t back;  // 0 or 1
    uint32_t otherSide;
    float texelSizeMeters;
};

/// Steps of one unit in the last place from a to b. pre: both finite and >= 0.
inline int32_t ulpsBetween(float a, float b) {
    return std::bit_cast<int32_t>(b) - std::bit_cast<int32_t>(a);
}
inline float movedByUlps(float a, int32_t ulps) {
    return std::bit_cast<float>(std::bit_cast<int32_t>(a) + ulps);
}

}  // namespace phat
