#pragma once
// Triangles as shaders read them: three corners on a grid, 32 bytes, two texels.
// twin: shaders/lib/bvh.glsl.

#include <array>
#include <span>

#include "core/base/math.h"

namespace phat {

/// Corners in steps of the grid as signed numbers of 28 bits, in the upper bits of words 0 to 7: the first
/// corner's x, y, z, the second's, the third's x and y. The third's z is in the lower 4 bits of words 0 to 6,
/// its lowest bits in word 0. The lower bits of word 7 are 0.
struct BvhTriangle {
    std::array<uint32_t, 8> words{};

    bool operator==(const BvhTriangle&) const = default;
};
static_assert(sizeof(BvhTriangle) == 32);

/// The grid of all corners of a scene at rest, so that triangles that share a corner still do. Its steps are
/// powers of two and one of its points is the origin: reading a corner rounds nothing, on any machine, and
/// coordinates of at least 1/8 of the largest on their axis are stored exactly.
struct BvhGrid {
    glm::vec3 stepMeters{1};

    /// The greatest error of a stored coordinate. Coordinates beyond kMaxCoordinate are clamped.
    glm::vec3 maxError() const { return 0.5f * stepMeters; }
};

/// Metres. Beyond it products of lengths may overflow.
inline constexpr float kMaxCoordinate = 0x1p40f;

BvhGrid gridOver(std::span<const glm::vec3> positions);
BvhTriangle packTriangle(const BvhGrid& grid, const std::array<glm::vec3, 3>& corners);
std::array<glm::vec3, 3> cornersOf(const BvhGrid& grid, const BvhTriangle& triangle);

}  // namespace phat
