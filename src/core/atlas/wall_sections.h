#pragma once
// Where walls stand on surfaces.

#include <vector>

#include "core/atlas/mesh_topology.h"
#include "core/scene/rays.h"

namespace phat {

/// A line on a triangle along which another triangle, a wall, stands on it or passes through it.
struct WallSection {
    uint32_t triangle = 0;
    glm::dvec3 from{0}, to{0};  // in the triangle
};

/// The sections of all triangles with all others a sixteenth of a texel above their lit sides: both sides of
/// double-sided materials. So a wall counts that ends just above a floor, and a rug does not. Sections are a
/// quarter of a texel, but at most half their length, longer at both ends where the triangle is, because
/// walls that meet in a corner seldom meet exactly. What lets light through (glass, alpha masks, blended
/// surfaces) and what animations move is no wall and has none. Ordered by triangle.
std::vector<WallSection> wallSections(const RayScene& rays, const MeshTopology& topology,
                                      double texelSizeMeters);

}  // namespace phat
