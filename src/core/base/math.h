#pragma once
// The numeric helpers of the whole program.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>

namespace phat {

inline constexpr float kPi = 3.14159265358979f;

/// Represents an infinite distance: a ray that left the scene.
inline constexpr float kFarDistance = 1e30f;

/// Relative luminance of a linear Rec. 709 colour.
inline float luminance(glm::vec3 rgb) {
    return glm::dot(rgb, glm::vec3(0.2126f, 0.7152f, 0.0722f));
}

inline float maxComponent(glm::vec3 v) {
    return std::max(v.x, std::max(v.y, v.z));
}

inline float square(float x) {
    return x * x;
}

/// Whether a vector has length 1, but for rounding.
inline bool isUnit(glm::vec3 v) {
    return std::abs(glm::dot(v, v) - 1.0f) < 1e-3f;
}

/// Right-handed orthonormal frame; local +z is the normal.
struct Frame {
    glm::vec3 tangent{1, 0, 0};
    glm::vec3 bitangent{0, 1, 0};
    glm::vec3 normal{0, 0, 1};

    glm::vec3 toWorld(glm::vec3 local) const {
        return local.x * tangent + local.y * bitangent + local.z * normal;
    }
    glm::vec3 toLocal(glm::vec3 world) const {
        return {glm::dot(world, tangent), glm::dot(world, bitangent), glm::dot(world, normal)};
    }
};

/// Any frame around a unit normal. source: Duff et al. 2017, "Building an Orthonormal Basis, Revisited".
Frame frameFromNormal(glm::vec3 normal);

/// Frame around `normal` whose tangent is `tangent` made orthogonal to it; falls back to frameFromNormal
/// when the two are parallel or `tangent` is zero. pre: |normal| = 1.
Frame frameFromNormalAndTangent(glm::vec3 normal, glm::vec3 tangent);

/// Point `index` of `count` spread evenly over the unit sphere. source: Swinbank and Purser 2006, "Fibonacci
/// grids".
glm::vec3 spherePoint(int index, int count);

}  // namespace phat
