#include "gl/draw_order.h"

#include <algorithm>

namespace phat {

bool isSeenThrough(const DrawnMaterials& materials, const DrawRange& draw) {
    return materials.of(draw).alphaMode == AlphaMode::blend || materials.glassOf(draw) != Glass::none;
}

std::vector<uint32_t> farToNear(const std::vector<DrawRange>& ranges, const DrawnMaterials& materials,
                                const Camera& camera) {
    std::vector<uint32_t> order;
    for (uint32_t i = 0; i < ranges.size(); ++i)
        if (isSeenThrough(materials, ranges[i])) order.push_back(i);
    const glm::vec3 eye(camera.worldFromCamera[3]), backward(camera.worldFromCamera[2]);
    const auto depth = [&](uint32_t i) {
        const glm::vec3 toward = eye - ranges[i].center;
        return camera.perspective ? glm::dot(toward, toward) : glm::dot(toward, backward);
    };
    std::stable_sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) { return depth(a) > depth(b); });
    return order;
}

}  // namespace phat
