#pragma once
// What the run-time lookup asks of a bake: which texel holds a direction, and how far away things are.
//
// A block of 32x32 texels is a directional picture stored scattered: the invertible layout of directions.h
// says which texel holds the sample of a cell of the block's unit square. ours (docs/pipeline.md).

#include <array>
#include <cstdint>
#include <vector>

#include "core/atlas.h"
#include "core/distance_probes.h"
#include "core/phatexture.h"
#include "core/progress.h"
#include "core/tile_patch.h"

namespace phat {

/// The guide as it is inverted: each cell's part of the unit square, in 255ths.
struct WarpCell {
    uint8_t uLow, uHigh, vLow, vHigh;
};
using Warp = std::array<WarpCell, kGuideCells>;  // [y][x]

struct LookupTables {
    std::vector<std::vector<uint16_t>>
        scrambles;                      // [layer][block]: the permutation of stratifiedSquare, 0..1023
    std::vector<Warp> warps;            // [guide]
    std::vector<DistanceProbe> probes;  // [tileY][tileX]
};

/// Tables of PHATexels of one kind. Empty where their directions do not follow the invertible layout (the
/// photon strategies): nothing can be looked up then. `patches`: fitTilePatches of the atlas; `rays`: of its
/// scene.
LookupTables buildLookupTables(const std::vector<PhatexelLayer>& layers, const std::vector<Guide>& guides,
                               const Atlas& atlas, const TexelPoints& points,
                               const std::vector<Frame>& frames, const std::vector<TilePatch>& patches,
                               const RayScene& rays, Progress& progress);

}  // namespace phat
