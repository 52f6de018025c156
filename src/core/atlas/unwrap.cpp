#include "core/atlas/unwrap.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "core/atlas/chart_mesh.h"
#include "core/atlas/unwrap_flatten.h"
#include "core/atlas/unwrap_grow.h"

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

// Turns grown pieces into charts, in halves where a piece overlaps, stretches or wastes its box.
struct Flattener {
    const Scene& scene;
    const MeshTopology& topology;
    double gutterMeters;
    const Progress& progress;

    double boxArea(const std::vector<FlatChart>& charts) const {
        double area = 0;
        for (const FlatChart& chart : charts)
            area += (chart.sizeMeters.x + 2 * gutterMeters) * (chart.sizeMeters.y + 2 * gutterMeters);
        return area;
    }

    std::vector<FlatChart> splitAndFlatten(const std::vector<uint32_t>& triangles, int trials) const {
        std::vector<FlatChart> charts;
        for (std::vector<uint32_t>& half : bisectChart(topology, triangles))
            for (FlatChart& chart : flatten(std::move(half), trials)) charts.push_back(std::move(chart));
        return charts;
    }

    // `trials`: how often a sound chart may still be halved for the sake of a smaller box.
    std::vector<FlatChart> flatten(std::vector<uint32_t> triangles, int trials) const {
        // The same criterion as for the whole atlas (95 % of the area), for every chart.
        constexpr double kMinGoodArea = 0.95;
        // A disc fills .785 of its box, a triangle .5; rings and arcs less.
        constexpr double kMinFill = 0.5;
        // Every cut costs a seam: boxes must shrink by a fifth.
        constexpr double kMinGain = 0.8;

        progress.throwIfStopped();
        std::vector<FlatChart> whole;
        {
            const ChartMesh mesh = buildChartMesh(scene, topology, triangles);
            std::vector<glm::dvec2> uv = flattenChart(mesh);
            if (isInjective(mesh, uv)) whole.push_back(finishChart(mesh, topology, std::move(uv)));
        }
        if (triangles.size() == 1) return whole;  // exact
        if (whole.empty() || whole[0].areaWithinStretch15 < kMinGoodArea)
            return splitAndFlatten(triangles, trials);
        const double fill = whole[0].area / (whole[0].sizeMeters.x * whole[0].sizeMeters.y);
        if (trials == 0 || fill >= kMinFill) return whole;
        std::vector<FlatChart> halves = splitAndFlatten(triangles, trials - 1);
        return boxArea(halves) < kMinGain * boxArea(whole) ? halves : whole;
    }
};

std::vector<uint32_t> usableTriangles(const MeshTopology& topology) {
    std::vector<uint32_t> triangles;
    for (uint32_t t = 0; t < topology.faceArea.size(); ++t)
        if (!topology.degenerate(t)) triangles.push_back(t);
    return triangles;
}

}  // namespace

std::vector<FlatChart> unwrapScene(const Scene& scene, const MeshTopology& topology,
                                   float maxNormalConeDegrees, double gutterMeters, Progress& progress) {
    // A ring needs two cuts before its boxes shrink; three make quarters of long arcs.
    constexpr int kBoxTrials = 3;

    const double cosCone = std::cos(glm::radians(double(std::clamp(maxNormalConeDegrees, 0.1f, 80.0f))));
    const std::vector<std::vector<uint32_t>> shells = connectedPieces(topology, usableTriangles(topology));

    // Pieces are worked on in parallel and kept in order.
    std::vector<std::vector<std::vector<uint32_t>>> grown(shells.size());
    tbb::parallel_for(size_t(0), shells.size(),
                      [&](size_t i) { grown[i] = growCharts(topology, shells[i], cosCone, progress); });
    std::vector<std::vector<uint32_t>> pieces;
    for (auto& list : grown)
        for (auto& piece : list) pieces.push_back(std::move(piece));

    const Flattener flattener{scene, topology, gutterMeters, progress};
    std::vector<std::vector<FlatChart>> flattened(pieces.size());
    tbb::parallel_for(size_t(0), pieces.size(), [&](size_t i) {
        const size_t count = pieces[i].size();
        flattened[i] = flattener.flatten(std::move(pieces[i]), kBoxTrials);
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
