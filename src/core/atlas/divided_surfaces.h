#pragma once
// Surfaces that walls divide, cut into the parts.
//
// A floor that goes on under the walls of a room would have texels of which one half is inside and the other
// outside, and everything that interpolates or filters would bring the daylight into the room. So surfaces
// are cut where walls stand, before the atlas is made: parts of a surface are surfaces of their own.

#include <vector>

#include "core/atlas/mesh_cutter.h"
#include "core/scene/rays.h"

namespace phat {

/// A surface and the parts that walls divide it into; only one where an edge that it shares with another
/// surface is cut there.
struct DividedSurface {
    uint32_t surface = 0;               // Scene::surfaces
    std::vector<CutVertex> vertices;    // new ones, counted on from those of the surface; from: counted in it
    std::vector<glm::uvec3> triangles;  // of vertices counted in the surface; those of a triangle together
    std::vector<uint32_t> part;         // per triangle, from 0
    uint32_t partCount = 0;
};

/// The surfaces of a scene that change when walls divide surfaces, ascending. A part is a set of regions that
/// do not touch: a region is what hangs together without crossing a wall. Walls that end within a region,
/// such as those with a doorway, do not divide it. What is under objects belongs to the region beside it, and
/// so does what is smaller than a texel. None where the cuts
/// would make four times as many triangles. `texelSizeMeters`: about that of the atlas to come.
std::vector<DividedSurface> divideAtWalls(const RayScene& rays, double texelSizeMeters);

}  // namespace phat
