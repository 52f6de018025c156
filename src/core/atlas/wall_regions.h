#pragma once
// The regions of a cut mesh that walls separate.

#include <vector>

#include "core/atlas/mesh_cutter.h"
#include "core/scene/rays.h"

namespace phat {

/// Whether a surface turns so sharply between two triangles, by their unit normals, that nothing is
/// interpolated there: by more than 60 degrees.
inline bool isFold(glm::dvec3 a, glm::dvec3 b) {
    return glm::dot(a, b) < 0.5;
}

struct WallRegions {
    std::vector<uint32_t> ofTriangle;  // per triangle of the cut mesh, numbered without gaps
    std::vector<uint32_t> part;        // per region: regions on both sides of a wall have different ones
    std::vector<uint8_t> separates;    // per section: whether different regions lie on its sides
};

/// Regions end at walls, and where the surface turns sharply. pre: `cutter` has cut the triangles of `rays`'s
/// scene at sections with the numbers below `sectionCount`.
WallRegions findWallRegions(const MeshCutter& cutter, const RayScene& rays, const MeshTopology& topology,
                            double texelSizeMeters, size_t sectionCount);

}  // namespace phat
