#pragma once
// Blocks of the atlas whose light is made anew, side by side in the targets of passes.
// twin: shaders/lib/texel_batch.glsl.

#include <array>
#include <span>

#include "core/atlas/atlas.h"
#include "core/dynamic/block_order.h"
#include "gl/gl_objects.h"
#include "gl/shader_loader.h"

namespace phat {

inline constexpr uint32_t kBatchSide = 8, kBatchBlocks = kBatchSide * kBatchSide;
inline constexpr uint32_t kBlockTiles = kBlockSize / kTileSize;  // along a side
/// Of a target with so many texels a block and side.
constexpr glm::uvec2 batchTarget(uint32_t texels) {
    return glm::uvec2(kBatchSide * texels);
}
/// The part of it that so many blocks take.
constexpr glm::uvec2 batchSize(size_t blocks, uint32_t texels) {
    return {kBatchSide * texels, (uint32_t(blocks) + kBatchSide - 1) / kBatchSide * texels};
}
/// Where the i-th block is in it.
constexpr glm::uvec2 batchCorner(size_t i, uint32_t texels) {
    return glm::uvec2(i % kBatchSide, i / kBatchSide) * texels;
}

/// Of a round: at most kBatchBlocks.
struct TexelBatch {
    std::span<const BlockRect> rects;  // [block] of the atlas
    std::span<const BlockTurn> blocks;

    /// `scrambleOf(turn)`: the layout of a block's samples, see stratifiedSquare.
    template <typename ScrambleOf>
    void set(const ShaderProgram& program, const ScrambleOf& scrambleOf) const {
        std::array<uint32_t, kBatchBlocks> scrambles{};
        for (size_t i = 0; i < blocks.size(); ++i) scrambles[i] = scrambleOf(blocks[i]);
        setEntries(program, scrambles);
    }
    glm::uvec2 size() const { return batchSize(blocks.size(), kBlockSize); }
    /// What was drawn for each block's texels, to its place in a layer of an atlas's texture.
    void copyTexels(const GlTexture& from, const GlTexture& to, int layer) const;

  private:
    void setEntries(const ShaderProgram& program, const std::array<uint32_t, kBatchBlocks>& scrambles) const;
};

}  // namespace phat
