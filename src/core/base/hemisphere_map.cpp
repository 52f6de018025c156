#include "core/base/hemisphere_map.h"

#include <cassert>
#include <cmath>

namespace phat {
namespace {

// Concentric square to unit disk. The two wedges differ by which coordinate is the radius.
glm::vec2 squareToDisk(glm::vec2 square) {
    const glm::vec2 s = 2.0f * square - 1.0f;
    if (s.x == 0.0f && s.y == 0.0f) return {0.0f, 0.0f};

    const bool xIsRadius = std::abs(s.x) > std::abs(s.y);
    const float radius = xIsRadius ? s.x : s.y;
    const float angle = xIsRadius ? kPi / 4 * (s.y / s.x) : kPi / 2 - kPi / 4 * (s.x / s.y);
    return radius * glm::vec2(std::cos(angle), std::sin(angle));
}

glm::vec2 diskToSquare(glm::vec2 disk) {
    const float radius = glm::length(disk);
    if (radius == 0.0f) return {0.5f, 0.5f};

    // Angle from the nearest axis of the wedge, in [-pi/4, pi/4].
    const bool xIsRadius = std::abs(disk.x) > std::abs(disk.y);
    const float along = xIsRadius ? disk.x : disk.y;
    const float across = xIsRadius ? disk.y : disk.x;
    const float signedRadius = std::copysign(radius, along);
    const float offset = signedRadius * (4 / kPi) * std::atan(across / along);
    const glm::vec2 s = xIsRadius ? glm::vec2(signedRadius, offset) : glm::vec2(offset, signedRadius);
    return 0.5f * (s + 1.0f);
}

}  // namespace

glm::vec3 squareToHemisphere(glm::vec2 square) {
    const glm::vec2 disk = squareToDisk(square);
    const float r2 = glm::dot(disk, disk);
    return {disk * std::sqrt(2.0f - r2), 1.0f - r2};  // Lambert: z = 1 - r^2
}

float squareToHemispherePdf(glm::vec3 direction) {
    return direction.z >= 0.0f ? 1.0f / (2.0f * kPi) : 0.0f;
}

glm::vec2 hemisphereToSquare(glm::vec3 direction) {
    assert(direction.z >= 0.0f);
    // 1 + z > 0 on the whole hemisphere, so the inverse projection has no singular point.
    return diskToSquare(glm::vec2(direction) / std::sqrt(1.0f + direction.z));
}

}  // namespace phat
