#include "core/atlas/earlier_charts.h"

#include <algorithm>
#include <cassert>

#include "core/atlas/atlas_plan.h"
#include "core/atlas/atlas_stats.h"
#include "core/atlas/far_density.h"
#include "core/atlas/glossy_density.h"
#include "core/base/median.h"
#include "core/scene/length_unit.h"

namespace phat {
namespace {

/// Calls visit(triangle, earlier triangle) for those of the surfaces that have an earlier one.
template <typename Visit>
void forEarlierTriangles(const Scene& scene, const EarlierCharts& earlier, const Visit& visit) {
    for (uint32_t s = 0; s < scene.surfaces.size(); ++s) {
        if (earlier.earlierSurface[s] == kNewSurface) continue;
        const Surface &now = scene.surfaces[s], &before = earlier.surfaces[earlier.earlierSurface[s]];
        assert(now.triangleCount == before.triangleCount);
        for (uint32_t t = 0; t < now.triangleCount; ++t)
            visit(now.firstTriangle + t, before.firstTriangle + t);
    }
}

bool hasSides(const Chart& chart, NeededSides needed) {
    const bool both = chart.otherSide != kNoChart;
    return both || !(chart.back ? needed.front : needed.back);
}

NeededSides neededOf(Sides sides) {
    return {sides != Sides::back, sides != Sides::front};
}

// Per chart of the earlier atlas: whether its sides are enough and its surfaces of one node.
std::vector<bool> usableCharts(const Scene& scene, const std::vector<Sides>& componentSides,
                               const EarlierCharts& earlier) {
    constexpr uint32_t kNoNode = ~0u;
    const std::vector<uint32_t> component =
        componentSides.empty() ? std::vector<uint32_t>() : connectedComponents(scene);
    const auto neededBy = [&](uint32_t triangle) {
        if (component.empty()) return neededOf(Sides::front);
        const uint32_t own = component[triangle];
        return earlier.needed.empty() ? neededOf(componentSides[own]) : earlier.needed[own];
    };
    std::vector<bool> usable(earlier.atlas.charts.size(), true);
    std::vector<uint32_t> node(usable.size(), kNoNode);
    forEarlierTriangles(scene, earlier, [&](uint32_t now, uint32_t before) {
        const uint32_t chart = earlier.atlas.triangleChart[before];
        if (chart == kNoChart) return;
        const uint32_t nodeNow = scene.surfaces[scene.triangleSurface[now]].node;
        if (node[chart] == kNoNode) node[chart] = nodeNow;
        if (node[chart] != nodeNow || !hasSides(earlier.atlas.charts[chart], neededBy(now)))
            usable[chart] = false;
    });
    return usable;
}

}  // namespace

std::vector<bool> keptSurfaces(const Scene& scene, const std::vector<Sides>& componentSides,
                               const EarlierCharts& earlier) {
    const Atlas& atlas = earlier.atlas;
    std::vector<bool> usable = usableCharts(scene, componentSides, earlier);
    std::vector<bool> kept(earlier.surfaces.size(), false);
    for (const uint32_t before : earlier.earlierSurface)
        if (before != kNewSurface) kept[before] = true;
    // A chart that is gone takes its surfaces along, and these their other charts.
    for (bool changed = true; changed;) {
        changed = false;
        for (size_t t = 0; t < atlas.triangleChart.size(); ++t) {
            const uint32_t chart = atlas.triangleChart[t], surface = atlas.triangleSurface[t];
            if (chart == kNoChart || usable[chart] == kept[surface]) continue;
            usable[chart] = kept[surface] = false;
            changed = true;
        }
    }
    std::vector<bool> result;
    for (const uint32_t before : earlier.earlierSurface)
        result.push_back(before != kNewSurface && kept[before]);
    return result;
}

namespace {

// The kept part of an earlier atlas; all other triangles have no chart.
Atlas keptPart(const Scene& scene, const EarlierCharts& earlier) {
    Atlas atlas;
    atlas.sizeTexels = earlier.atlas.sizeTexels;
    atlas.triangleSurface = scene.triangleSurface;
    atlas.triangleChart.assign(scene.triangles.size(), kNoChart);
    atlas.triangleTexels.assign(scene.triangles.size(), {});
    std::vector<uint32_t> surfaceNow(earlier.surfaces.size(), kNewSurface);
    for (uint32_t s = 0; s < scene.surfaces.size(); ++s)
        if (earlier.earlierSurface[s] != kNewSurface) surfaceNow[earlier.earlierSurface[s]] = s;
    std::vector<uint32_t> chartNow(earlier.atlas.charts.size(), kNoChart);
    for (uint32_t c = 0; c < chartNow.size(); ++c) {
        Chart chart = earlier.atlas.charts[c];
        if (surfaceNow[chart.surface] == kNewSurface) continue;
        chart.surface = surfaceNow[chart.surface];
        chartNow[c] = uint32_t(atlas.charts.size());
        atlas.texelSizeMeters = std::max(atlas.texelSizeMeters, chart.texelSizeMeters);
        atlas.charts.push_back(chart);
    }
    for (Chart& chart : atlas.charts)
        if (chart.otherSide != kNoChart) chart.otherSide = chartNow[chart.otherSide];
    forEarlierTriangles(scene, earlier, [&](uint32_t now, uint32_t before) {
        const uint32_t chart = earlier.atlas.triangleChart[before];
        if (chart != kNoChart) atlas.triangleChart[now] = chartNow[chart];
        atlas.triangleTexels[now] = earlier.atlas.triangleTexels[before];
    });
    return atlas;
}

// The size of texels of density 1: the median over the tiles of all charts. Those of one tile along a side do
// not count if there are others: what is smaller than a tile has finer texels than it was made for.
double usualTexelSize(const Scene& scene, const Atlas& atlas, const std::vector<double>& farDensity,
                      const AtlasSettings& settings) {
    if (settings.texelSizeMeters > 0) return settings.texelSizeMeters;
    const std::vector<float> glossy = glossyDensities(scene, settings.glossyDensity);
    std::vector<uint32_t> triangleOf(atlas.charts.size(), 0);
    for (uint32_t t = 0; t < atlas.triangleChart.size(); ++t)
        if (atlas.triangleChart[t] != kNoChart) triangleOf[atlas.triangleChart[t]] = t;
    std::vector<std::pair<double, double>> ofSmall, ofLarge;  // sizes and tiles
    for (uint32_t c = 0; c < atlas.charts.size(); ++c) {
        const Chart& chart = atlas.charts[c];
        if (chart.otherSide < c) continue;  // its triangles are those of the other
        const double density = double(glossy[chart.surface]) * farDensity[triangleOf[c]];
        const bool small = chart.sizeTiles.x == 1 || chart.sizeTiles.y == 1;
        (small ? ofSmall : ofLarge)
            .emplace_back(double(chart.texelSizeMeters) * density,
                          double(chart.sizeTiles.x) * double(chart.sizeTiles.y));
    }
    return weightedMedianOf(ofLarge.empty() ? std::move(ofSmall) : std::move(ofLarge));
}

// Triangles without area are what the unwrapper leaves out.
void leaveOut(MeshTopology& topology, const Scene& scene, const std::vector<bool>& surfaces) {
    for (uint32_t t = 0; t < scene.triangles.size(); ++t) {
        if (!surfaces[scene.triangleSurface[t]]) continue;
        topology.faceArea[t] = 0;
        topology.faceNormal[t] = glm::dvec3(0);
        topology.neighborAcross[t].fill(kNoNeighbor);
    }
}

TakenTiles tilesOf(const Atlas& atlas) {
    TakenTiles taken{atlas.sizeTiles().x, {}};
    for (const Chart& chart : atlas.charts) taken.rectangles.emplace_back(chart.originTile, chart.sizeTiles);
    return taken;
}

// Both atlases' charts; no triangle has one in both.
Atlas joined(Atlas atlas, const Atlas& added) {
    const auto first = uint32_t(atlas.charts.size());
    for (Chart chart : added.charts) {
        if (chart.otherSide != kNoChart) chart.otherSide += first;
        atlas.charts.push_back(chart);
    }
    for (size_t t = 0; t < atlas.triangleChart.size(); ++t) {
        if (added.triangleChart[t] == kNoChart) continue;
        atlas.triangleChart[t] = added.triangleChart[t] + first;
        atlas.triangleTexels[t] = added.triangleTexels[t];
    }
    atlas.texelSizeMeters = std::max(atlas.texelSizeMeters, added.texelSizeMeters);
    atlas.sizeTexels = added.sizeTexels;
    fillTileTable(atlas);
    return atlas;
}

}  // namespace

Atlas buildAtlasOn(const EarlierCharts& earlier, const RayScene& rays,
                   const std::vector<Sides>& componentSides, const AtlasSettings& settings,
                   Progress& progress, AtlasStats* stats) {
    const Scene& scene = rays.scene();
    const std::vector<bool> kept = keptSurfaces(scene, componentSides, earlier);
    EarlierCharts usable = earlier;
    for (size_t s = 0; s < kept.size(); ++s)
        if (!kept[s]) usable.earlierSurface[s] = kNewSurface;
    Atlas atlas = keptPart(scene, usable);
    if (atlas.charts.empty()) return buildAtlas(rays, componentSides, settings, progress, stats);

    ProgressStage stage(progress, "unwrap", scene.triangles.size());
    const MeshTopology whole = buildTopology(scene);
    MeshTopology topology = whole;
    leaveOut(topology, scene, kept);
    const std::vector<double> farDensity = farDensitiesOfTriangles(scene, whole);
    const AtlasOrder order{
        scene,      &rays, componentSides, settings, usualTexelSize(scene, atlas, farDensity, settings),
        &farDensity};
    const Pieces pieces = makePieces(order, topology, progress);
    const std::vector<PieceClass> classes = classesOf(scene, pieces, Common::node);
    const std::vector<ChartPlan> plans = planCharts(
        groupPieces(scene, topology, pieces.flats, classes, settings.gutterTexels, progress), pieces);
    const Packing packing =
        packChartsAround(boxesOf(pieces, plans, classes), settings, order.texelSizeMeters, tilesOf(atlas));
    const auto keptCharts = uint32_t(atlas.charts.size());
    atlas = joined(std::move(atlas), placeCharts(scene, pieces, plans, packing));
    atlas.unitMeters = lengthUnit(scene);
    if (stats) {
        *stats = statsOf(atlas, pieces.flats, whole);
        stats->keptCharts = keptCharts;
    }
    return atlas;
}

}  // namespace phat
