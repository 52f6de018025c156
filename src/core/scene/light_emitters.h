#pragma once
// Triangles that shine.

#include <span>
#include <vector>

#include "core/scene/shading.h"

namespace phat {

struct EmissiveTriangle {
    uint32_t triangle = 0;
    float areaSquareMeters = 0;
    glm::vec3 normal{0, 0, 1};  // geometric, of the front
    glm::vec3 radiance{0};      // mean over the triangle, alpha applied, nit
    bool uniform = false;       // `radiance` holds everywhere
    bool doubleSided = false;

    float sides() const { return doubleSided ? 2.0f : 1.0f; }
    glm::vec3 power() const { return kPi * areaSquareMeters * sides() * radiance; }  // W
};

/// All triangles that emit anywhere, in triangle order. Those of zero area are left out: no ray finds them.
std::vector<EmissiveTriangle> findEmissiveTriangles(const Scene& scene);

/// Radiance that leaves the emitter at a point, opacity applied: rays pass what is transparent.
glm::vec3 emittedRadiance(const Scene& scene, const EmissiveTriangle& emitter, glm::vec2 barycentric);

/// Area-preserving. source: Heitz 2019, "A Low-Distortion Map Between Triangle and Square".
glm::vec2 squareToTriangle(glm::vec2 square);

glm::vec3 pointOnTriangle(const Scene& scene, uint32_t triangle, glm::vec2 barycentric);

}  // namespace phat
