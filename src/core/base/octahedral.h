#pragma once

#include "core/base/math.h"

namespace phat {

/// Unit direction to the square [-1,1]^2, the octahedron unfolded.
/// source: Cigolle et al. 2014, "A Survey of Efficient Representations for Independent Unit Vectors".
inline glm::vec2 octahedralFromDirection(glm::vec3 d) {
    d /= std::abs(d.x) + std::abs(d.y) + std::abs(d.z);
    if (d.z >= 0.0f) return {d.x, d.y};
    return {(1.0f - std::abs(d.y)) * (d.x >= 0.0f ? 1.0f : -1.0f),
            (1.0f - std::abs(d.x)) * (d.y >= 0.0f ? 1.0f : -1.0f)};
}

}  // namespace phat
