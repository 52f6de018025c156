#pragma once
// Constants common to the writer and the reader of baked files, as specified in docs/format.md.

#include <bit>
#include <cassert>
#include <cstdint>

#include "core/phatexel/depth_probes.h"

namespace phat {

inline constexpr uint64_t kBakedFormatVersion = 3;
/// Of files whose PHATexels are not packed: they say how, and programs that know version 3 alone refuse them.
inline constexpr uint64_t kStorageFormatVersion = 4;
/// Of files with charts that have pieces of several surfaces; the PHATexels of these may be packed or not.
inline constexpr uint64_t kSharedChartsFormatVersion = 5;
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

/// Distances around a tile: levels of two neighbouring directions a byte, the lower bits first. The range of
/// the levels is in the tile's PackedTile.
using LevelsRecord = std::array<uint8_t, kProbeSize * kProbeSize / 2>;

inline LevelsRecord packLevels(const DepthProbe& probe) {
    LevelsRecord record;
    for (size_t i = 0; i < record.size(); ++i)
        record[i] = uint8_t(probe.level[2 * i] | probe.level[2 * i + 1] << 4);
    return record;
}
inline DepthProbe unpackProbe(const LevelsRecord& record, const PackedTile& tile) {
    DepthProbe probe{tile[0].w >> 19 & 63u, tile[0].w >> 25 & 63u, {}};
    for (size_t i = 0; i < record.size(); ++i) {
        probe.level[2 * i] = record[i] & 15;
        probe.level[2 * i + 1] = record[i] >> 4;
    }
    return probe;
}

/// Steps of one unit in the last place from a to b. pre: both finite and >= 0.
inline int32_t ulpsBetween(float a, float b) {
    assert(std::isfinite(a) && std::isfinite(b) && a >= 0 && b >= 0);
    return std::bit_cast<int32_t>(b) - std::bit_cast<int32_t>(a);
}
inline float movedByUlps(float a, int32_t ulps) {
    return std::bit_cast<float>(std::bit_cast<int32_t>(a) + ulps);
}

}  // namespace phat
