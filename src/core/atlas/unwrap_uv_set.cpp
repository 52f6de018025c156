// Charts from a UV set that the scene brings along.

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "core/atlas/atlas_raster.h"
#include "core/atlas/chart_mesh.h"
#include "core/atlas/unwrap.h"
#include "core/atlas/unwrap_flatten.h"
#include "core/atlas/unwrap_grow.h"

namespace phat {
namespace {

[[noreturn]] void refuse(int uvSet, const std::string& reason) {
    throw std::runtime_error("UV set " + std::to_string(uvSet) + ": " + reason);
}

double signedArea(const std::array<glm::vec2, 3>& uv) {
    const glm::dvec2 e1 = glm::dvec2(uv[1]) - glm::dvec2(uv[0]), e2 = glm::dvec2(uv[2]) - glm::dvec2(uv[0]);
    return 0.5 * (e1.x * e2.y - e1.y * e2.x);
}

std::array<glm::vec2, 3> cornersOf(const Scene& scene, const std::vector<glm::vec2>& uv, uint32_t triangle) {
    const glm::uvec3& v = scene.triangles[triangle];
    return {uv[v[0]], uv[v[1]], uv[v[2]]};
}

void checkRange(const Scene& scene, const MeshTopology& topology, const std::vector<glm::vec2>& uv,
                int uvSet) {
    // Exporters round; a millionth outside is still the border of any texture.
    constexpr float kSlack = 1e-6f;
    // In units of the whole square: under a hundredth of a texel even in the largest atlas.
    constexpr double kMinArea = 1e-13;
    for (uint32_t t = 0; t < scene.triangles.size(); ++t) {
        if (topology.degenerate(t)) continue;
        const auto corners = cornersOf(scene, uv, t);
        for (const glm::vec2& p : corners) {
            if (!std::isfinite(p.x) || !std::isfinite(p.y))
                refuse(uvSet, "triangle " + std::to_string(t) + " has coordinates that are not finite");
            if (p.x < -kSlack || p.y < -kSlack || p.x > 1 + kSlack || p.y > 1 + kSlack)
                refuse(uvSet, "triangle " + std::to_string(t) + " lies outside [0, 1]");
        }
        if (std::abs(signedArea(corners)) < kMinArea)
            refuse(uvSet, "triangle " + std::to_string(t) + " has no area");
    }
}

void checkOverlaps(const Scene& scene, const MeshTopology& topology, const std::vector<glm::vec2>& uv,
                   int uvSet, uint32_t resolution, const Progress& progress) {
    std::vector<uint32_t> owner(size_t(resolution) * resolution, kNoNeighbor);
    for (uint32_t t = 0; t < scene.triangles.size(); ++t) {
        if (topology.degenerate(t)) continue;
        if (t % 1024 == 0) progress.throwIfStopped();
        auto corners = cornersOf(scene, uv, t);
        if (signedArea(corners) < 0) std::swap(corners[1], corners[2]);
        for (glm::vec2& p : corners) p *= float(resolution);
        forEachTexel(corners, int(resolution), int(resolution), [&](int x, int y) {
            uint32_t& o = owner[size_t(y) * resolution + x];
            if (o != kNoNeighbor)
                refuse(uvSet, "triangles " + std::to_string(o) + " and " + std::to_string(t) + " overlap");
            o = t;
        });
    }
}

// The topology with all edges cut where the UV set has a seam or folds over.
MeshTopology cutAtSeams(const Scene& scene, const MeshTopology& topology, const std::vector<glm::vec2>& uv) {
    MeshTopology cut = topology;
    for (uint32_t t = 0; t < scene.triangles.size(); ++t) {
        for (int edge = 0; edge < 3; ++edge) {
            const uint32_t n = topology.neighborAcross[t][edge];
            if (n == kNoNeighbor) continue;
            const auto sameAt = [&](uint32_t vertex) {
                for (int corner = 0; corner < 3; ++corner) {
                    const uint32_t other = scene.triangles[n][corner];
                    if (topology.weldedVertex[other] == topology.weldedVertex[vertex])
                        return uv[other] == uv[vertex];
                }
                return false;
            };
            const bool together =
                sameAt(scene.triangles[t][edge]) && sameAt(scene.triangles[t][(edge + 1) % 3]) &&
                (signedArea(cornersOf(scene, uv, t)) > 0) == (signedArea(cornersOf(scene, uv, n)) > 0);
            if (!together) cut.neighborAcross[t][edge] = kNoNeighbor;
        }
    }
    return cut;
}

FlatChart flattenIsland(const Scene& scene, const MeshTopology& cut, const std::vector<glm::vec2>& uv,
                        std::vector<uint32_t> triangles) {
    const ChartMesh mesh = buildChartMesh(scene, cut, std::move(triangles));
    const bool mirrored = signedArea(cornersOf(scene, uv, mesh.triangles[0])) < 0;
    std::vector<glm::dvec2> positions(mesh.vertexCount());
    double uvArea = 0;
    FlatChart chart;
    for (size_t t = 0; t < mesh.triangles.size(); ++t) {
        const auto corners = cornersOf(scene, uv, mesh.triangles[t]);
        uvArea += std::abs(signedArea(corners));
        chart.area += cut.faceArea[mesh.triangles[t]];
        for (int corner = 0; corner < 3; ++corner)
            positions[mesh.corners[t][corner]] = {mirrored ? -corners[corner].x : corners[corner].x,
                                                  corners[corner].y};
    }
    for (glm::dvec2& p : positions) p *= std::sqrt(chart.area / uvArea);

    chart.triangles = mesh.triangles;
    chart.sizeMeters = alignToBox(positions);
    for (size_t t = 0; t < mesh.triangles.size(); ++t) {
        const auto& [a, b, c] = mesh.corners[t];
        chart.uvMeters.push_back({positions[a], positions[b], positions[c]});
        if (stretchOf(uvFromSurface(mesh, positions, t)) <= kGoodStretch)
            chart.areaWithinStretch15 += cut.faceArea[mesh.triangles[t]] / chart.area;
    }
    return chart;
}

}  // namespace

std::vector<FlatChart> chartsFromUvSet(const Scene& scene, const MeshTopology& topology, int uvSet,
                                       uint32_t checkResolution, Progress& progress) {
    if (uvSet < 0 || uvSet > 1) refuse(uvSet, "only sets 0 and 1 can serve");
    const std::vector<glm::vec2>& uv = uvSet == 0 ? scene.uv0 : scene.uv1;
    if (uv.size() != scene.positions.size()) refuse(uvSet, "the scene does not have it");
    checkRange(scene, topology, uv, uvSet);
    checkOverlaps(scene, topology, uv, uvSet, checkResolution, progress);

    const MeshTopology cut = cutAtSeams(scene, topology, uv);
    std::vector<uint32_t> triangles;
    for (uint32_t t = 0; t < scene.triangles.size(); ++t)
        if (!cut.degenerate(t)) triangles.push_back(t);
    std::vector<FlatChart> charts;
    for (std::vector<uint32_t>& island : connectedPieces(cut, triangles)) {
        progress.throwIfStopped();
        progress.advance(island.size());
        charts.push_back(flattenIsland(scene, cut, uv, std::move(island)));
    }
    return charts;
}

}  // namespace phat
