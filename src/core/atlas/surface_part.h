#pragma once
// Parts of surfaces with texture coordinates of their own.

#include <array>
#include <cstdint>
#include <vector>

#include "core/base/math.h"

namespace phat {

/// Triangles of one surface that become a primitive of their own in a file.
struct SurfacePart {
    std::vector<uint32_t> triangles;            // of the scene, ascending
    std::vector<std::array<glm::vec2, 3>> uvs;  // of these triangles' corners, in [0, 1]
    uint32_t page = 0;                          // of an atlas in pages
    /// What is drawn is the triangles' back, as the front of a single-sided primitive: its triangles are
    /// turned around, normals and tangents with them.
    bool back = false;
    bool oneSided = false;  // the other side is another part, although the material is double-sided
};

}  // namespace phat
