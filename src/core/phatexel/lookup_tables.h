#pragma once
// The tables that the run-time lookup reads beside the PHATexels: which texel holds a direction, where texels
// are, and how far away things are.
//
// A block of 32x32 texels is a directional picture stored scattered: the invertible layout of directions.h
// says which texel holds the sample of a cell of the block's unit square. ours (docs/lookup.md).

#include <array>
#include <cstdint>
#include <vector>

#include "core/atlas/atlas.h"
#include "core/base/progress.h"
#include "core/phatexel/phatexture.h"

namespace phat {

/// The guide as it is inverted: each cell's part of the unit square, in 255ths.
/// twin: inverseCdfOf in web/src/tables.js.
struct InverseCdfCell {
    uint8_t uLow, uHigh, vLow, vHigh;
};
using InverseCdf = std::array<InverseCdfCell, kGuideCells>;  // [y][x]

InverseCdf inverseCdfOf(const Guide& guide);

/// Whether the direction that a texel looks in follows from its position in its block, in every layer.
bool canLookUp(const std::vector<PhatexelLayer>& layers, const std::vector<Guide>& guides);

/// Packs the element of `tilePatches` of a tile that has a chart. `probe`: the tile's, or of zeros.
PackedTile packedTileOf(const Phatexture& phatexture, const Atlas& atlas, const TilePatch& patch,
                        const Frame& frame, const DepthProbe& probe, size_t tile);

/// Fills `tilePatches`, and `probes` where anything can be looked up. `frames`: blockFrames of the atlas;
/// `rays`: of its scene.
void prepareLookup(Phatexture& phatexture, const Atlas& atlas, const TexelPoints& points,
                   const std::vector<Frame>& frames, const RayScene& rays, Progress& progress);

/// Fills `tilePatches` alone, for the `probes` that there are. `patches`: fitTilePatches of the atlas.
void packTiles(Phatexture& phatexture, const Atlas& atlas, const std::vector<TilePatch>& patches,
               const std::vector<Frame>& frames);

}  // namespace phat
