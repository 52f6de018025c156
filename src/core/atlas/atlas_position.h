#pragma once
// From a hit to its position in the atlas, in texels.

#include "core/atlas/atlas.h"

namespace phat {

struct AtlasPosition {
    uint32_t chart = kNoChart;  // kNoChart: this side of the triangle has no texels
    glm::vec2 texel{0};
};

/// The position of a hit on the side that was hit; none in an empty atlas.
AtlasPosition atlasPositionOf(const Atlas& atlas, const Hit& hit);

/// Bilinear inside the chart; `lookup(index)` returns the value of a texel. Zero where no texel around is of
/// the chart.
template <typename Lookup>
glm::vec3 bilinearAt(const Atlas& atlas, const AtlasPosition& position, const Lookup& lookup) {
    const glm::vec2 corner = glm::floor(position.texel - 0.5f);
    const glm::vec2 t = position.texel - 0.5f - corner;
    glm::vec3 sum(0);
    float weights = 0;
    for (int i = 0; i < 4; ++i) {
        const glm::ivec2 side(i & 1, i >> 1);
        const glm::ivec2 texel = glm::ivec2(corner) + side;
        if (glm::any(glm::lessThan(texel, glm::ivec2(0))) ||
            glm::any(glm::greaterThanEqual(texel, glm::ivec2(atlas.sizeTexels))) ||
            atlas.chartAt(texel) != position.chart)
            continue;
        const glm::vec2 w = glm::mix(1.0f - t, t, glm::vec2(side));
        sum += w.x * w.y * lookup(size_t(texel.y) * atlas.sizeTexels.x + size_t(texel.x));
        weights += w.x * w.y;
    }
    return weights > 0.0f ? sum / weights : glm::vec3(0);
}

}  // namespace phat
