#pragma once
// Tables of 16x16 texels, one for each guide, side by side in a texture.

#include <algorithm>
#include <array>
#include <glm/glm.hpp>
#include <vector>

#include "core/phatexel/phatexture.h"
#include "gl/textures.h"

namespace phat {

/// twin: kTablesWide in shaders/lib/lookup_tables.glsl; others take it from the texture's size.
inline constexpr uint32_t kTablesWide = 512;

/// Of a texel and its kind in memory.
struct TableFormat {
    GLenum stored, format, type;
};

inline glm::uvec2 guideCorner(uint32_t guide) {
    return glm::uvec2(guide % kTablesWide, guide / kTablesWide) * uint32_t(kGuideSize);
}

template <typename Texel>
void updateGuideTable(const GlTexture& texture, const TableFormat& format, uint32_t guide,
                      const std::array<Texel, kGuideCells>& table) {
    const glm::uvec2 corner = guideCorner(guide);
    glTextureSubImage2D(texture.name(), 0, GLint(corner.x), GLint(corner.y), kGuideSize, kGuideSize,
                        format.format, format.type, table.data());
}

/// Throws GlError.
template <typename Texel>
GlTexture uploadGuideTables(const TableFormat& format,
                            const std::vector<std::array<Texel, kGuideCells>>& tables) {
    const uint32_t count = std::max<uint32_t>(1, uint32_t(tables.size()));
    const glm::uvec2 size =
        glm::uvec2(std::min(count, kTablesWide), (count + kTablesWide - 1) / kTablesWide) *
        uint32_t(kGuideSize);
    std::vector<Texel> texels(size_t(size.x) * size.y);
    for (uint32_t i = 0; i < tables.size(); ++i) {
        const glm::uvec2 corner = guideCorner(i);
        for (uint32_t y = 0; y < kGuideSize; ++y)
            std::copy_n(&tables[i][y * kGuideSize], kGuideSize,
                        &texels[size_t(corner.y + y) * size.x + corner.x]);
    }
    GlTexture texture = createTexture2D(format.stored, size);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    glTextureSubImage2D(texture.name(), 0, 0, 0, GLsizei(size.x), GLsizei(size.y), format.format, format.type,
                        texels.data());
    return texture;
}

}  // namespace phat
