#include "gl/texel_batch.h"

#include <algorithm>

namespace phat {
namespace {

// What was known before counts as so many samples: few for as long as a change spreads from bounce to
// bounce, and then ever more.
uint32_t maxSamples(BlockTurn turn) {
    constexpr uint32_t kMin = 4, kSpreading = 32;
    const uint32_t since = std::min(turn.rounds, kMin) + (std::max(turn.rounds, kSpreading) - kSpreading) / 4;
    return std::max({since, turn.kept, 1u});
}

}  // namespace

void TexelBatch::setEntries(const ShaderProgram& program,
                            const std::array<uint32_t, kBatchBlocks>& scrambles) const {
    std::array<glm::uvec4, kBatchBlocks> entries{};
    for (size_t i = 0; i < blocks.size(); ++i) {
        const BlockRect& rect = rects[blocks[i].block];
        entries[i] = {rect.origin.y << 16 | rect.origin.x, rect.size.y << 16 | rect.size.x, blocks[i].block,
                      maxSamples(blocks[i]) << 16 | scrambles[i]};
    }
    program.set("batchBlocks", std::span<const glm::uvec4>(entries));
}

void TexelBatch::copyTexels(const GlTexture& from, const GlTexture& to, int layer) const {
    for (size_t i = 0; i < blocks.size(); ++i) {
        const BlockRect& rect = rects[blocks[i].block];
        const glm::uvec2 corner = batchCorner(i, kBlockSize);
        glCopyImageSubData(from.name(), GL_TEXTURE_2D, 0, GLint(corner.x), GLint(corner.y), 0, to.name(),
                           GL_TEXTURE_2D_ARRAY, 0, GLint(rect.origin.x), GLint(rect.origin.y), layer,
                           GLsizei(rect.size.x), GLsizei(rect.size.y), 1);
    }
}

}  // namespace phat
