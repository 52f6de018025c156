#include "core/atlas/atlas.h"

#include <cassert>
#include <cmath>
#include <stdexcept>

#include "core/atlas/atlas_pack.h"
#include "core/atlas/atlas_raster.h"
#include "core/atlas/glossy_density.h"
#include "core/atlas/mesh_topology.h"
#include "core/atlas/unwrap.h"

namespace phat {
namespace {

// Which flat chart a packed box is, and the side that its texels are for.
struct Side {
    uint32_t flat;
    bool back;
    double density = 1;  // texels along a length, over those of rough surfaces
};

std::vector<Side> chooseSides(const Scene& scene, const std::vector<FlatChart>& flats,
                              const std::vector<Sides>& componentSides) {
    const std::vector<uint32_t> component =
        componentSides.empty() ? std::vector<uint32_t>() : connectedComponents(scene);
    std::vector<Side> sides;
    for (uint32_t f = 0; f < flats.size(); ++f) {
        Sides lit = Sides::front;
        if (!component.empty()) {
            assert(component[flats[f].triangles[0]] < componentSides.size());
            lit = componentSides[component[flats[f].triangles[0]]];
        }
        if (lit != Sides::back) sides.push_back({f, false});
        if (lit != Sides::front) sides.push_back({f, true});
    }
    return sides;
}

void chooseDensities(const Scene& scene, const std::vector<FlatChart>& flats, const AtlasSettings& settings,
                     std::vector<Side>& sides) {
    const std::vector<float> ofSurface = glossyDensities(scene, settings.glossyDensity);
    std::vector<double> area, density;
    for (const Side& side : sides) {
        const FlatChart& flat = flats[side.flat];
        area.push_back(flat.area);
        density.push_back(double(ofSurface[scene.triangleSurface[flat.triangles[0]]]));
    }
    if (settings.texelSizeMeters <= 0) keepBudget(area, density);
    for (size_t i = 0; i < sides.size(); ++i) sides[i].density = density[i];
}

// Where a chart's low corner sits in its rectangle: centred, edges on texel borders; a chart narrower than a
// texel on a texel's centre, so that it has surface texels at all.
double offsetOf(double sizeTexels, uint32_t roomTexels) {
    const double offset = std::floor(0.5 * (double(roomTexels) - sizeTexels) + 1e-4);
    return sizeTexels < 1 ? offset + 0.5 - 0.5 * sizeTexels : offset;
}

void placeTriangles(Atlas& atlas, const FlatChart& flat, uint32_t chartIndex, bool turned) {
    const Chart& chart = atlas.charts[chartIndex];
    const double scale = 1.0 / chart.texelSizeMeters;
    const glm::dvec2 size =
        scale * (turned ? glm::dvec2(flat.sizeMeters.y, flat.sizeMeters.x) : flat.sizeMeters);
    const glm::dvec2 low =
        glm::dvec2(chart.originTexel()) +
        glm::dvec2(offsetOf(size.x, chart.sizeTexels().x), offsetOf(size.y, chart.sizeTexels().y));
    for (size_t t = 0; t < flat.triangles.size(); ++t) {
        atlas.triangleChart[flat.triangles[t]] = chartIndex;
        for (int corner = 0; corner < 3; ++corner) {
            glm::dvec2 uv = flat.uvMeters[t][corner];
            if (turned) uv = {flat.sizeMeters.y - uv.y, uv.x};
            atlas.triangleTexels[flat.triangles[t]][corner] = glm::vec2(low + scale * uv);
        }
    }
}

void fillTileTable(Atlas& atlas) {
    atlas.tileChart.assign(size_t(atlas.sizeTiles().x) * atlas.sizeTiles().y, kNoChart);
    for (uint32_t c = 0; c < atlas.charts.size(); ++c) {
        const Chart& chart = atlas.charts[c];
        for (uint32_t y = 0; y < chart.sizeTiles.y; ++y)
            for (uint32_t x = 0; x < chart.sizeTiles.x; ++x)
                atlas.tileChart[size_t(chart.originTile.y + y) * atlas.sizeTiles().x + chart.originTile.x +
                                x] = c;
    }
}

Atlas placeCharts(const Scene& scene, const std::vector<FlatChart>& flats, const std::vector<Side>& sides,
                  const Packing& packing) {
    Atlas atlas;
    atlas.sizeTexels = packing.sizeTiles * kTileSize;
    atlas.texelSizeMeters = sides.empty() ? float(packing.texelSizeMeters) : 0.0f;
    atlas.triangleChart.assign(scene.triangles.size(), kNoChart);
    atlas.triangleTexels.assign(scene.triangles.size(), {});
    for (uint32_t c = 0; c < sides.size(); ++c) {
        const uint32_t flat = sides[c].flat;
        Chart chart;
        chart.originTile = packing.originTile[c];
        chart.sizeTiles = packing.chartTiles[c];
        chart.texelSizeMeters = float(packing.texelSizeMeters / (sides[c].density * packing.scale[c]));
        atlas.texelSizeMeters = std::max(atlas.texelSizeMeters, chart.texelSizeMeters);
        chart.surface = scene.triangleSurface[flats[flat].triangles[0]];
        chart.back = sides[c].back;
        const bool second = c > 0 && sides[c - 1].flat == flat;
        if (second) {
            chart.otherSide = c - 1;
            atlas.charts[c - 1].otherSide = c;
        }
        atlas.charts.push_back(chart);
        if (!second) placeTriangles(atlas, flats[flat], c, packing.turned[c]);
    }
    fillTileTable(atlas);
    numberBlocks(atlas);
    return atlas;
}

float coverageOf(const Atlas& atlas) {
    std::vector<bool> occupied(atlas.texelCount(), false);
    for (size_t t = 0; t < atlas.triangleChart.size(); ++t) {
        if (atlas.triangleChart[t] == kNoChart) continue;
        const Chart& chart = atlas.charts[atlas.triangleChart[t]];
        const glm::uvec2 toOther = chart.otherSide == kNoChart
                                       ? glm::uvec2(0)
                                       : atlas.charts[chart.otherSide].originTexel() - chart.originTexel();
        forEachTexel(atlas.triangleTexels[t], int(atlas.sizeTexels.x), int(atlas.sizeTexels.y),
                     [&](int x, int y) {
                         const glm::uvec2 texel(x, y),
                             other = texel + toOther;  // wraps around, as unsigned numbers do
                         occupied[size_t(texel.y) * atlas.sizeTexels.x + texel.x] = true;
                         occupied[size_t(other.y) * atlas.sizeTexels.x + other.x] = true;
                     });
    }
    size_t count = 0;
    for (const bool c : occupied) count += c;
    return atlas.texelCount() ? float(double(count) / double(atlas.texelCount())) : 0.0f;
}

// About the texel size that will come out, before anything is packed.
double guessTexelSize(const MeshTopology& topology, const AtlasSettings& settings) {
    // Occupied fraction of the atlas; the scenes in scenes/ reach .74 to .90.
    constexpr double kUsualCoverage = 0.75;
    if (settings.texelSizeMeters > 0) return settings.texelSizeMeters;
    double area = 0;
    for (const double a : topology.faceArea) area += a;
    return std::sqrt(area / (kUsualCoverage * double(std::max<uint64_t>(settings.texelBudget, 1))));
}

// Texels a side at which a UV set is searched for overlaps: about the size of the atlas.
uint32_t checkResolutionFor(const MeshTopology& topology, double texelSizeMeters) {
    double area = 0;
    for (const double a : topology.faceArea) area += a;
    // At least 512: a small budget must not hide overlaps behind coarse texels.
    return uint32_t(std::clamp(std::sqrt(area) / std::max(texelSizeMeters, 1e-30), 512.0, 8192.0));
}

}  // namespace

std::vector<BlockRect> blockRects(const Atlas& atlas) {
    std::vector<BlockRect> rects(atlas.blockCount);
    for (const Chart& chart : atlas.charts) {
        for (uint32_t y = 0; y < chart.blocksHigh(); ++y)
            for (uint32_t x = 0; x < chart.blocksWide(); ++x) {
                const glm::uvec2 offset = glm::uvec2(x, y) * kBlockSize;
                rects[chart.firstBlock + y * chart.blocksWide() + x] = {
                    chart.originTexel() + offset,
                    glm::min(glm::uvec2(kBlockSize), chart.sizeTexels() - offset)};
            }
    }
    return rects;
}

void numberBlocks(Atlas& atlas) {
    atlas.blockCount = 0;
    for (Chart& chart : atlas.charts) {
        chart.firstBlock = atlas.blockCount;
        atlas.blockCount += chart.blocksWide() * chart.blocksHigh();
    }
}

Atlas buildAtlas(const Scene& scene, const std::vector<Sides>& componentSides, const AtlasSettings& settings,
                 Progress& progress, AtlasStats* stats) {
    if (!(settings.glossyDensity >= 1 && settings.glossyDensity <= kMaxGlossyDensity))
        throw std::invalid_argument("the density of glossy surfaces must be from 1 to 8");
    progress.begin("unwrap", scene.triangles.size());
    const MeshTopology topology = buildTopology(scene);
    const double texelSize = guessTexelSize(topology, settings);
    const std::vector<FlatChart> flats =
        settings.useUvSet >= 0 ? chartsFromUvSet(scene, topology, settings.useUvSet,
                                                 checkResolutionFor(topology, texelSize), progress)
                               : unwrapScene(scene, topology, settings.maxNormalConeDegrees,
                                             settings.gutterTexels * texelSize, progress);

    std::vector<Side> sides = chooseSides(scene, flats, componentSides);
    chooseDensities(scene, flats, settings, sides);
    std::vector<PackBox> boxes;
    for (size_t i = 0; i < sides.size(); ++i) {
        const bool second = i > 0 && sides[i - 1].flat == sides[i].flat;
        boxes.push_back({sides[i].density * flats[sides[i].flat].sizeMeters, second});
    }
    Packing packing = packCharts(boxes, settings, progress);
    if (boxes.empty() && !scene.triangles.empty()) {
        // Triangles without area have no charts but stay in the file: one tile without a chart holds their
        // UVs.
        packing.texelSizeMeters = 1;
        packing.sizeTiles = glm::uvec2(1);
    }
    Atlas atlas = placeCharts(scene, flats, sides, packing);
    progress.end();

    if (stats) {
        double area = 0, good = 0;
        for (const FlatChart& flat : flats) {
            area += flat.area;
            good += flat.area * flat.areaWithinStretch15;
        }
        stats->chartCount = uint32_t(atlas.charts.size());
        stats->coverage = coverageOf(atlas);
        stats->areaWithinStretch15 = area > 0 ? float(good / area) : 1.0f;
        stats->degenerateTriangles = 0;
        for (uint32_t t = 0; t < scene.triangles.size(); ++t)
            stats->degenerateTriangles += topology.degenerate(t);
    }
    return atlas;
}

}  // namespace phat
