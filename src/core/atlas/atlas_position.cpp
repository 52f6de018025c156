#include "core/atlas/atlas_position.h"

namespace phat {

AtlasPosition atlasPositionOf(const Atlas& atlas, const Hit& hit) {
    AtlasPosition position;
    if (atlas.triangleChart.empty()) return position;
    position.chart = atlas.triangleChart[hit.triangle];
    if (position.chart == kNoChart) return position;
    const std::array<glm::vec2, 3>& corner = atlas.triangleTexels[hit.triangle];
    position.texel =
        corner[0] + hit.barycentric.x * (corner[1] - corner[0]) + hit.barycentric.y * (corner[2] - corner[0]);
    const Chart& chart = atlas.charts[position.chart];
    if (hit.backFace != chart.back) {
        if (chart.otherSide == kNoChart) return {};
        // Twins have the same size and the same layout.
        position.texel +=
            glm::vec2(atlas.charts[chart.otherSide].originTexel()) - glm::vec2(chart.originTexel());
        position.chart = chart.otherSide;
    }
    return position;
}

}  // namespace phat
