#pragma once
// One chart while it is flattened.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/atlas/mesh_topology.h"

namespace phat {

/// A connected piece of surface with vertices of its own: a welded vertex that the piece touches with two
/// separate fans is two vertices here, so that the fans may part in the plane.
struct ChartMesh {
    struct Edge {
        uint32_t from, to;  // vertices, counter-clockwise around `triangle`
        uint32_t triangle;  // index into `triangles`
    };
    std::vector<uint32_t> triangles;               // the scene's, ascending
    std::vector<std::array<uint32_t, 3>> corners;  // per triangle: vertices
    std::vector<glm::dvec3> positions;             // per vertex
    std::vector<uint32_t> weldedVertex;            // per vertex: the topology's
    std::vector<Edge> boundary;

    size_t vertexCount() const { return positions.size(); }
};

/// pre: `triangles` is ascending and holds no degenerate triangle.
ChartMesh buildChartMesh(const Scene& scene, const MeshTopology& topology, std::vector<uint32_t> triangles);

/// Derivative of the plane by the surface at one triangle: columns belong to an orthonormal basis of it.
glm::dmat2 uvFromSurface(const ChartMesh& mesh, std::span<const glm::dvec2> uv, size_t triangle);

/// max(sigma1, 1 / sigma2) of a Jacobian: 1 is isometric, infinite is flat or flipped.
/// source: Sorkine et al. 2002, "Bounded-distortion piecewise mesh parameterization".
double stretchOf(const glm::dmat2& jacobian);

}  // namespace phat
