#pragma once
// Distances around each tile of an atlas, from which the lookup takes the expected distance of a hit.

#include <array>
#include <cstdint>
#include <vector>

#include "core/phatexel/tile_patch.h"
#include "core/scene/rays.h"

namespace phat {

/// Distances that rays from TilePatch::probeTexel meet, by direction: an equal-area map of the hemisphere
/// (hemisphere_map.h) in the block's frame, one ray through the middle of each cell. Sixteen levels a cell;
/// the codes of packDistance would make no difference (notes/experiments.md).
inline constexpr int kProbeSize = 16;
inline constexpr uint32_t kFarLevel = 15;
struct DepthProbe {
    uint32_t low = 0, high = 0;  // a quarter of the codes of levels 0 and 14; 15 is infinity
    std::array<uint8_t, kProbeSize * kProbeSize> level;  // [y][x]
};

/// Metres, or kFarDistance; `unitMeters`: Atlas::unitMeters. twin: levelDistance in
/// shaders/lib/lookup_tables.glsl.
float probeDistance(const DepthProbe& probe, uint32_t level, float unitMeters);

/// Of one tile; of an empty one all levels are far.
DepthProbe traceDepthProbe(const Atlas& atlas, const TexelPoints& points, const std::vector<Frame>& frames,
                           const TilePatch& patch, size_t tile, const RayScene& rays);

/// One a tile, [tileY][tileX].
std::vector<DepthProbe> traceDepthProbes(const Atlas& atlas, const TexelPoints& points,
                                         const std::vector<Frame>& frames,
                                         const std::vector<TilePatch>& patches, const RayScene& rays,
                                         Progress& progress);

}  // namespace phat
