#include "core/scene/ray_opacity.h"

#include <bit>

#include "core/base/random.h"
#include "core/scene/shading.h"

namespace phat {
namespace {

uint64_t bitsHash(glm::vec3 v) {
    return hashOf(std::bit_cast<uint32_t>(v.x), std::bit_cast<uint32_t>(v.y), std::bit_cast<uint32_t>(v.z));
}

}  // namespace

bool passesThrough(const Scene& scene, uint32_t triangle, glm::vec2 barycentric, glm::vec3 origin,
                   glm::vec3 direction) {
    const float opacity = opacityAt(scene, triangle, barycentric);
    if (opacity >= 1.0f) return false;
    if (opacity <= 0.0f) return true;
    const uint64_t bits = hashOf(bitsHash(origin), bitsHash(direction), triangle);
    return float(bits >> 40) * 0x1p-24f >= opacity;
}

}  // namespace phat
