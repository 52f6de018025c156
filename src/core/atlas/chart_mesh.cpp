#include "core/atlas/chart_mesh.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "core/base/disjoint_sets.h"

namespace phat {
ChartMesh buildChartMesh(const Scene& scene, const MeshTopology& topology, std::vector<uint32_t> triangles) {
    assert(std::is_sorted(triangles.begin(), triangles.end()));
    ChartMesh mesh;
    mesh.triangles = std::move(triangles);
    const uint32_t count = uint32_t(mesh.triangles.size());
    const auto welded = [&](uint32_t t, uint32_t corner) {
        return topology.weldedVertex[scene.triangles[mesh.triangles[t]][corner % 3]];
    };

    // Corners are the same vertex when they meet across an edge inside the chart.
    DisjointSets vertices(3 * size_t(count));
    std::vector<std::pair<uint32_t, uint32_t>> boundaryCorners;
    for (uint32_t t = 0; t < count; ++t) {
        for (uint32_t corner = 0; corner < 3; ++corner) {
            const uint32_t neighbor = topology.neighborAcross[mesh.triangles[t]][corner];
            const auto found = std::lower_bound(mesh.triangles.begin(), mesh.triangles.end(), neighbor);
            if (neighbor == kNoNeighbor || found == mesh.triangles.end() || *found != neighbor) {
                boundaryCorners.emplace_back(t, corner);
                continue;
            }
            const uint32_t n = uint32_t(found - mesh.triangles.begin());
            for (uint32_t other = 0; other < 3; ++other) {
                if (welded(n, other) != welded(t, corner + 1) || welded(n, other + 1) != welded(t, corner))
                    continue;
                vertices.unite(3 * n + other, 3 * t + (corner + 1) % 3);
                vertices.unite(3 * n + (other + 1) % 3, 3 * t + corner);
                break;
            }
        }
    }

    std::vector<uint32_t> vertexOfRoot(vertices.size(), ~0u);
    mesh.corners.resize(count);
    for (uint32_t t = 0; t < count; ++t) {
        for (uint32_t corner = 0; corner < 3; ++corner) {
            uint32_t& vertex = vertexOfRoot[vertices.find(3 * t + corner)];
            if (vertex == ~0u) {
                vertex = uint32_t(mesh.positions.size());
                mesh.positions.push_back(scene.positions[welded(t, corner)]);
                mesh.weldedVertex.push_back(welded(t, corner));
            }
            mesh.corners[t][corner] = vertex;
        }
    }
    for (const auto& [t, corner] : boundaryCorners)
        mesh.boundary.push_back({mesh.corners[t][corner], mesh.corners[t][(corner + 1) % 3], t});
    return mesh;
}

glm::dmat2 uvFromSurface(const ChartMesh& mesh, std::span<const glm::dvec2> uv, size_t triangle) {
    const auto& [a, b, c] = mesh.corners[triangle];
    const glm::dvec3 e1 = mesh.positions[b] - mesh.positions[a];
    const glm::dvec3 e2 = mesh.positions[c] - mesh.positions[a];
    const double length1 = glm::length(e1);
    const double along = glm::dot(e1, e2) / length1;
    const double height = glm::length(glm::cross(e1, e2)) / length1;
    const glm::dvec2 d1 = (uv[b] - uv[a]) / length1;
    return {d1, (uv[c] - uv[a] - along * d1) / height};
}

double stretchOf(const glm::dmat2& jacobian) {
    // Singular values from the rotating and the reflecting part. source: Blinn 1996, "Consider the lowly
    // 2x2 matrix".
    const double e = 0.5 * (jacobian[0][0] + jacobian[1][1]), f = 0.5 * (jacobian[0][0] - jacobian[1][1]);
    const double g = 0.5 * (jacobian[0][1] + jacobian[1][0]), h = 0.5 * (jacobian[0][1] - jacobian[1][0]);
    const double q = std::hypot(e, h), r = std::hypot(f, g);
    const double sigma1 = q + r, sigma2 = q - r;  // sigma2 < 0: flipped
    if (!(sigma2 > 0)) return std::numeric_limits<double>::infinity();
    return std::max(sigma1, 1.0 / sigma2);
}

}  // namespace phat
