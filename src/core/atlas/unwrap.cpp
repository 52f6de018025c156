#include "core/atlas/unwrap.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "core/atlas/box_parts.h"
#include "core/atlas/chart_mesh.h"
#include "core/atlas/piece_place.h"
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
    ChartCost cost;
    const Progress& progress;

    double texelsOf(const std::vector<FlatChart>& charts) const {
        double texels = 0;
        for (const FlatChart& chart : charts)
            texels += texelsTaken(chart.sizeMeters / cost.texelSizeMeters, cost.gutterTexels);
        return texels;
    }

    std::vector<FlatChart> flattenAll(std::vector<std::vector<uint32_t>> pieces, int trials) const {
        std::vector<FlatChart> charts;
        for (std::vector<uint32_t>& piece : pieces)
            for (FlatChart& chart : flatten(std::move(piece), trials)) charts.push_back(std::move(chart));
        return charts;
    }

    std::vector<std::vector<uint32_t>> partsOf(const FlatChart& chart) const {
        // Limits the time that large charts take; their halves may have fewer.
        constexpr size_t kMaxTriangles = 1000;
        if (chart.triangles.size() > kMaxTriangles) return bisectChart(topology, chart.triangles);
        return partsWithSmallBoxes(topology, chart, cost.texelSizeMeters);
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
            return flattenAll(bisectChart(topology, triangles), trials);
        const double fill = whole[0].area / (whole[0].sizeMeters.x * whole[0].sizeMeters.y);
        if (trials == 0 || fill >= kMinFill) return whole;
        std::vector<std::vector<uint32_t>> parts = partsOf(whole[0]);
        if (parts.size() < 2) return whole;
        std::vector<FlatChart> cut = flattenAll(std::move(parts), trials - 1);
        return texelsOf(cut) < kMinGain * texelsOf(whole) ? cut : whole;
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
                                   float maxNormalConeDegrees, const ChartCost& cost, Progress& progress) {
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

    const Flattener flattener{scene, topology, cost, progress};
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
