#include "viewer/texel_probe.h"

namespace phat {

std::optional<TexelUnderMouse> texelUnderMouse(const ViewerState& state) {
    const Document& document = *state.document;
    if (state.mouse.x < 0 || !document.hasBake) return std::nullopt;
    const Ray ray = cameraRay(state.navigation.camera, state.pictureSize.x, state.pictureSize.y, state.mouse);
    uint64_t rays = 0;
    const Hit hit = visibleHit(document.rays(), ray, rays);
    if (!hit) return std::nullopt;
    const Atlas& atlas = document.baked.atlas;
    uint32_t chart = atlas.triangleChart[hit.triangle];
    if (chart == kNoChart) return std::nullopt;
    const auto& corners = atlas.triangleTexels[hit.triangle];
    glm::vec2 position = corners[0] + hit.barycentric.x * (corners[1] - corners[0]) +
                         hit.barycentric.y * (corners[2] - corners[0]);
    if (atlas.charts[chart].back != hit.backFace) {
        const uint32_t other = atlas.charts[chart].otherSide;
        if (other == kNoChart) return std::nullopt;
        position +=
            glm::vec2(atlas.charts[other].originTexel()) - glm::vec2(atlas.charts[chart].originTexel());
        chart = other;
    }
    const glm::uvec2 texel = glm::min(glm::uvec2(glm::max(position, 0.0f)), atlas.sizeTexels - 1u);
    if (atlas.chartAt(texel) != chart) return std::nullopt;
    const Phatexture& stored = document.baked.phatexture;
    const Inspection& inspection = state.view.inspection;
    const bool area = inspection.source == 1 && !stored.area.empty();
    const auto& layers = area ? stored.area : stored.indirect;
    const auto& guides = area ? stored.areaGuides : stored.indirectGuides;
    const size_t layer = std::min(size_t(inspection.layer), layers.size() - 1);
    return TexelUnderMouse{texel, chart, atlas.charts[chart].texelSizeMeters,
                           phatexelAt(layers[layer], guides, atlas, texel)};
}

}  // namespace phat
