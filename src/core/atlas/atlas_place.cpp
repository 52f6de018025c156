#include "core/atlas/atlas_place.h"

namespace phat {

AtlasPlace atlasPlaceOf(const Atlas& atlas, const Hit& hit) {
    AtlasPlace place;
    if (atlas.triangleChart.empty()) return place;
    place.chart = atlas.triangleChart[hit.triangle];
    if (place.chart == kNoChart) return place;
    const std::array<glm::vec2, 3>& corner = atlas.triangleTexels[hit.triangle];
    place.texel =
        corner[0] + hit.barycentric.x * (corner[1] - corner[0]) + hit.barycentric.y * (corner[2] - corner[0]);
    const Chart& chart = atlas.charts[place.chart];
    if (hit.backFace != chart.back) {
        if (chart.otherSide == kNoChart) return {};
        // Twins have the same size and the same layout.
        place.texel +=
            glm::vec2(atlas.charts[chart.otherSide].originTexel()) - glm::vec2(chart.originTexel());
        place.chart = chart.otherSide;
    }
    return place;
}

}  // namespace phat
