#pragma once
// The shadow of a straight edge in the light of a disc.

#include <algorithm>
#include <cmath>

#include "support/scene_builder.h"

namespace phat::test {

/// The fraction of a disc that is on one side of a line, `offset` radii from its middle: what a point sees
/// that is so far out of the shadow of an edge, in radii of the disc's shadow.
inline double discFraction(double offset) {
    const double t = std::clamp(offset, -1.0, 1.0);
    return 0.5 + (t * std::sqrt(1 - t * t) + std::asin(t)) / 3.14159265358979;
}

inline constexpr float kEdgeHeight = 12;

/// A white floor below a sun in the zenith, of 1 W/m2, and a half plane at kEdgeHeight over x < 0.
inline Scene floorBehindEdge(float angularRadius) {
    Scene scene;
    addFloor(scene, lambert(1), 4);
    addQuad(scene, lambert(0), {-4, kEdgeHeight, -2}, {4, 0, 0}, {0, 0, 4});
    scene.lights.push_back(directionalLight(glm::vec3(1), {0, -1, 0}));
    scene.lights.back().angularRadius = angularRadius;
    return scene;
}

}  // namespace phat::test
