#pragma once
// A flat piece of surface in the world.

#include "core/atlas/unwrap.h"

namespace phat {

struct PiecePose {
    glm::dvec3 center{0}, normal{0};      // means over the area
    double lean = 0;                      // largest angle of a triangle's normal to the mean, radians
    glm::dvec3 tangent{0}, bitangent{0};  // along growing x and y of the flat piece

    /// The direction of growing x after so many right angles, counter-clockwise.
    glm::dvec3 xAfter(uint32_t turns) const {
        const glm::dvec3 axis[4] = {tangent, -bitangent, -tangent, bitangent};
        return axis[turns % 4];
    }
    /// The turn after which the piece's x axis points most nearly along `direction`.
    uint32_t turnToward(const glm::dvec3& direction) const;
};

PiecePose poseOf(const Scene& scene, const MeshTopology& topology, const FlatChart& flat);

/// A position of a flat piece of this size, after it was turned.
glm::dvec2 turnedPosition(glm::dvec2 p, glm::dvec2 size, uint32_t turns);
inline glm::dvec2 turnedSize(glm::dvec2 size, uint32_t turns) {
    return turns % 2 == 0 ? size : glm::dvec2(size.y, size.x);
}

/// What is common to pieces that may share a chart.
struct PieceClass {
    uint32_t kind = 0;           // equal for pieces that may share one at all
    double texelSizeMeters = 0;  // about that of the piece's texels
};

}  // namespace phat
