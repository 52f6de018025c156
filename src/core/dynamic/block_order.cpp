#include "core/dynamic/block_order.h"

#include <algorithm>
#include <numeric>

namespace phat {
namespace {

// Rounds of blocks outside the view count as so many: they still light what is visible.
constexpr float kUnseenCount = 4;

}  // namespace

BlockOrder::BlockOrder(const Atlas& atlas, const TexelPoints& points) {
    for (const BlockRect& rect : blockRects(atlas)) {
        Bounds bounds;
        glm::vec3 normal(0);
        for (uint32_t y = 0; y < rect.size.y; ++y)
            for (uint32_t x = 0; x < rect.size.x; ++x) {
                const size_t texel = size_t(rect.origin.y + y) * atlas.sizeTexels.x + rect.origin.x + x;
                if (!points.valid(texel)) continue;
                bounds.add(points.position[texel]);
                normal += points.normal[texel];
            }
        Place place;
        if (!bounds.empty()) place = {bounds.center(), normal, 0.5f * bounds.diagonal()};
        places_.push_back(place);
    }
    rounds_.assign(places_.size(), 0);
    unsettled_ = places_.size();
}

void BlockOrder::noteChange() {
    std::fill(rounds_.begin(), rounds_.end(), 0u);
    unsettled_ = places_.size();
}

std::vector<BlockTurn> BlockOrder::next(size_t count, const Camera& eye) {
    const glm::mat4 cameraFromWorld = glm::inverse(eye.worldFromCamera);
    const glm::vec3 position(eye.worldFromCamera[3]);
    const auto outOfView = [&](const Place& place) {
        const glm::vec3 local = cameraFromWorld * glm::vec4(place.center, 1);
        if (!eye.perspective) return std::abs(local.y) > eye.ymag + place.radius;
        if (local.z > place.radius) return true;
        // Blocks that are bent have short mean normals.
        if (glm::dot(position - place.center, place.normal) < -place.radius * glm::length(place.normal))
            return true;
        const float aspect = eye.aspect > 0 ? eye.aspect : 16.0f / 9;
        const float half = -local.z * std::tan(0.5f * eye.yfovRadians);
        return std::abs(local.y) > half + 2 * place.radius ||
               std::abs(local.x) > half * aspect + 2 * place.radius;
    };
    std::vector<uint32_t> order;
    std::vector<float> due(places_.size());
    for (uint32_t block = 0; block < places_.size(); ++block) {
        if (rounds_[block] >= kSettledRounds) continue;
        due[block] = float(rounds_[block]) * (outOfView(places_[block]) ? kUnseenCount : 1.0f);
        order.push_back(block);
    }
    count = std::min(count, order.size());
    std::partial_sort(order.begin(), order.begin() + ptrdiff_t(count), order.end(),
                      [&](uint32_t a, uint32_t b) { return due[a] != due[b] ? due[a] < due[b] : a < b; });
    std::vector<BlockTurn> turns;
    for (size_t i = 0; i < count; ++i) {
        turns.push_back({order[i], rounds_[order[i]]++});
        unsettled_ -= rounds_[order[i]] == kSettledRounds;
    }
    return turns;
}

}  // namespace phat
