#pragma once

#include <array>

#include "core/scene/scene.h"

namespace phat {

/// Where a triangle's corners are, as glm::vec3 or glm::dvec3.
template <typename Vector = glm::vec3>
std::array<Vector, 3> cornersOf(const Scene& scene, uint32_t triangle) {
    const glm::uvec3& v = scene.triangles[triangle];
    return {Vector(scene.positions[v.x]), Vector(scene.positions[v.y]), Vector(scene.positions[v.z])};
}

}  // namespace phat
