#pragma once
// Which triangles touch, and across which edges a chart may grow.

#include <array>
#include <cstdint>
#include <vector>

#include "core/scene/scene.h"

namespace phat {

inline constexpr uint32_t kNoNeighbor = ~0u;

/// Adjacency of a scene's triangles. Triangles of different surfaces never touch.
struct MeshTopology {
    std::vector<uint32_t> weldedVertex;  // per vertex: the first of its surface at its position
    std::vector<std::array<uint32_t, 3>>
        neighborAcross;                  // per triangle: across the edge corner i, corner i + 1
    std::vector<glm::dvec3> faceNormal;  // per triangle, unit; 0 if degenerate
    std::vector<double> faceArea;        // per triangle, square metres; 0 if degenerate

    bool degenerate(uint32_t triangle) const { return faceArea[triangle] == 0; }
};

/// Neighbours are mutual, share two welded vertices and have the same winding. Where more than two triangles
/// meet in an edge, those with the most similar normals are paired. Degenerate triangles have no neighbours.
MeshTopology buildTopology(const Scene& scene);

}  // namespace phat
