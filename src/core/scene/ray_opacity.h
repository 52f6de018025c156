#pragma once
// Whether a ray goes on through a surface that is not opaque.

#include "core/scene/scene.h"

namespace phat {

/// Alpha-masked texels are passed through; blended ones with probability 1 - alpha, decided by a hash of the
/// ray's own bits and the triangle: the same ray always gets the same answer, on any thread and in any order.
/// twin: shaders/lib/bvh_opacity.glsl.
bool passesThrough(const Scene& scene, uint32_t triangle, glm::vec2 barycentric, glm::vec3 origin,
                   glm::vec3 direction);

}  // namespace phat
