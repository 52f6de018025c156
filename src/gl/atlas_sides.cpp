#include "gl/atlas_sides.h"

namespace phat {

AtlasSides atlasSidesOf(const Atlas& atlas, uint32_t triangle) {
    AtlasSides sides;
    const uint32_t own = atlas.triangleChart[triangle];
    if (own == kNoChart) return sides;
    const Chart& chart = atlas.charts[own];
    const uint32_t other = chart.otherSide;
    sides.charts = chart.back ? glm::uvec2(other, own) : glm::uvec2(own, other);
    if (other != kNoChart) {
        const glm::vec2 offset =
            glm::vec2(atlas.charts[other].originTexel()) - glm::vec2(chart.originTexel());
        (chart.back ? sides.frontOffset : sides.backOffset) = offset;
    }
    return sides;
}

}  // namespace phat
