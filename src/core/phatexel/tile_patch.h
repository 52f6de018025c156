#pragma once
// Where an atlas's texels are, by the tile: a quadric instead of 64 positions. ours, because positions would
// take more memory than the PHATexels themselves.

#include <array>
#include <vector>

#include "core/atlas/atlas.h"

namespace phat {

/// Texel (x, y) from the tile's middle, counted in texels, is at
/// center + x alongX + y alongY + (bend.x x^2 + bend.y x y + bend.z y^2) normal, the normal its block's.
struct TilePatch {
    glm::vec3 center{0};
    glm::vec3 alongX{0}, alongY{0};  // metres a texel
    glm::vec3 bend{0};               // metres a squared texel
    /// The patch holds in the block's aligned group of 2^groupBits texels a side around the tile, 3 to 5.
    uint32_t groupBits = 3;
    /// The tile's texel that has a surface and is nearest to its middle: y * 8 + x. See DepthProbe.
    uint32_t probeTexel = 0;
    bool empty = true;  // no texel of the tile has a surface

    glm::vec3 at(glm::vec2 fromMiddle, glm::vec3 normal) const {
        const glm::vec3 squares(fromMiddle.x * fromMiddle.x, fromMiddle.x * fromMiddle.y,
                                fromMiddle.y * fromMiddle.y);
        return center + fromMiddle.x * alongX + fromMiddle.y * alongY + glm::dot(bend, squares) * normal;
    }
};

/// Of one tile that has a chart.
TilePatch fitTilePatch(const Atlas& atlas, const TexelPoints& points, const std::vector<Frame>& frames,
                       size_t tile);

/// One a tile, [tileY][tileX], least squares over its texels, already rounded to what packTile holds.
/// `frames`: blockFrames of the atlas.
std::vector<TilePatch> fitTilePatches(const Atlas& atlas, const TexelPoints& points,
                                      const std::vector<Frame>& frames);

/// 32 bytes for the GPU and the file: patch, frame of the block, the scramble of the first layer of indirect
/// light, low and high of the tile's DepthProbe. twin: unpackTile in shaders/lib/tile_patch.glsl.
using PackedTile = std::array<glm::uvec4, 2>;
PackedTile packTile(const TilePatch& patch, const Frame& blockFrame, float texelMeters, uint32_t scramble,
                    glm::uvec2 probeRange);

}  // namespace phat
