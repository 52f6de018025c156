#include "core/unwrap.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "core/chart_mesh.h"
#include "core/unwrap_flatten.h"
#include "core/unwrap_grow.h"

namespace phat {
namespace {

FlatChart finishChart(const ChartMesh& mesh, const MeshTopology& topology, std::vector<glm::dvec2> uv) {
    FlatChart chart;
    chart.triangles = mesh.triangles;
    chart.sizeMeters = alignToBox(uv);
    chart.uvMeters.reserve(mesh.triangles.size());
    for (size_t t = 0; t < mesh.triangles.size(); ++t) {
        const auto& [a, b, c] = mesh.corners[t];
        chart.uvMeters.push_back({uv[a], uv[b], uv[c]});
        const double area = topology.faceArea[mesh.triangles[t]];
        chart.area += area;
        if (stretchOf(uvFromSurface(mesh, uv, t)) <= kGoodStretch) chart.areaWithinStretch15 += area;
    }
    chart.areaWithinStretch15 /= chart.area;
    return chart;
}

// Flattens one grown piece; where that overlaps or stretches, its halves.
std::vector<FlatChart> flattenOrSplit(const Scene& scene, const MeshTopology& topology,
                                      std::vector<uint32_t> triangles, const Progress& progress) {
    // What the whole atlas is asked for (95 % of the area), of every chart.
    constexpr double kMinGoodArea = 0.95;

    std::vector<FlatChart> done;
    std::vector<std::vector<uint32_t>> open{std::move(triangles)};
    while (!open.empty()) {
        progress.throwIfStopped();
        const ChartMesh mesh = buildChartMesh(scene, topology, std::move(open.back()));
        open.pop_back();
        std::vector<glm::dvec2> uv = flattenChart(mesh);
        if (isInjective(mesh, uv)) {
            FlatChart chart = finishChart(mesh, topology, std::move(uv));
            if (chart.areaWithinStretch15 >= kMinGoodArea || mesh.triangles.size() == 1) {
                done.push_back(std::move(chart));
                continue;
            }
        }
        if (mesh.triangles.size() == 1) continue;  // not reached: one triangle is flattened exactly
        for (std::vector<uint32_t>& half : bisectChart(topology, mesh.triangles))
            open.push_back(std::move(half));
    }
    return done;
}

std::vector<uint32_t> usableTriangles(const MeshTopology& topology) {
    std::vector<uint32_t> triangles;
    for (uint32_t t = 0; t < topology.faceArea.size(); ++t)
        if (!topology.degenerate(t)) triangles.push_back(t);
    return triangles;
}

}  // namespace

std::vector<FlatChart> unwrapScene(const Scene& scene, const MeshTopology& topology,
                                   float maxNormalConeDegrees, Progress& progress) {
    const double cosCone = std::cos(glm::radians(double(std::clamp(maxNormalConeDegrees, 0.1f, 80.0f))));
    const std::vector<std::vector<uint32_t>> shells = connectedPieces(topology, usableTriangles(topology));

    // Pieces are worked on in parallel and kept in order.
    std::vector<std::vector<std::vector<uint32_t>>> grown(shells.size());
    tbb::parallel_for(size_t(0), shells.size(),
                      [&](size_t i) { grown[i] = growCharts(topology, shells[i], cosCone, progress); });
    std::vector<std::vector<uint32_t>> pieces;
    for (auto& list : grown)
        for (auto& piece : list) pieces.push_back(std::move(piece));

    std::vector<std::vector<FlatChart>> flattened(pieces.size());
    tbb::parallel_for(size_t(0), pieces.size(), [&](size_t i) {
        const size_t count = pieces[i].size();
        flattened[i] = flattenOrSplit(scene, topology, std::move(pieces[i]), progress);
        progress.advance(count);
    });
    std::vector<FlatChart> charts;
    for (auto& list : flattened)
        for (auto& chart : list) charts.push_back(std::move(chart));
    std::sort(charts.begin(), charts.end(),
              [](const FlatChart& a, const FlatChart& b) { return a.triangles[0] < b.triangles[0]; });
    return charts;
}

}  // namespace phat
