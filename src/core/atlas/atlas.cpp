#include "core/atlas/atlas.h"

#include <cassert>
#include <cmath>
#include <map>
#include <optional>
#include <stdexcept>
#include <tuple>

#include "core/atlas/atlas_pack.h"
#include "core/atlas/atlas_stats.h"
#include "core/atlas/far_density.h"
#include "core/atlas/glossy_density.h"
#include "core/atlas/join_coplanar.h"
#include "core/atlas/mesh_topology.h"
#include "core/atlas/piece_views.h"
#include "core/atlas/unwrap.h"
#include "core/scene/length_unit.h"

namespace phat {
namespace {

// The flat pieces with what their charts are chosen by.
struct Pieces {
    std::vector<FlatChart> flats;
    std::vector<Sides> sides;      // per piece
    std::vector<double> density;   // per piece
    std::vector<PieceView> views;  // per piece, or empty
    double aboutTexelSizeMeters = 0;

    uint32_t surface(const Scene& scene, uint32_t piece) const {
        return scene.triangleSurface[flats[piece].triangles[0]];
    }
};

// A chart before it is packed.
struct ChartPlan {
    PieceGroup pieces;
    bool back = false;   // its texels face away from the triangles' front
    bool twin = false;   // the other side of the plan before
    double density = 1;  // texels along a length, over those of rough surfaces
};

// Per flat piece.
std::vector<Sides> chooseSides(const Scene& scene, const std::vector<FlatChart>& flats,
                               const std::vector<Sides>& componentSides) {
    std::vector<Sides> sides(flats.size(), Sides::front);
    if (componentSides.empty()) return sides;
    const std::vector<uint32_t> component = connectedComponents(scene);
    for (uint32_t f = 0; f < flats.size(); ++f) {
        assert(component[flats[f].triangles[0]] < componentSides.size());
        sides[f] = componentSides[component[flats[f].triangles[0]]];
    }
    return sides;
}

// Of all sides that have texels, square metres.
double litArea(const FlatChart& flat, Sides sides) {
    return sides == Sides::both ? 2 * flat.area : flat.area;
}

// Per flat piece.
std::vector<double> chooseDensities(const Scene& scene, const Pieces& pieces, const AtlasSettings& settings) {
    const std::vector<float> ofSurface = glossyDensities(scene, settings.glossyDensity);
    std::vector<double> area, density;
    for (uint32_t f = 0; f < pieces.flats.size(); ++f) {
        area.push_back(litArea(pieces.flats[f], pieces.sides[f]));
        density.push_back(double(ofSurface[pieces.surface(scene, f)]));
    }
    if (settings.texelSizeMeters > 0) return density;
    keepBudget(area, density);
    const std::vector<double> ofFar = farDensities(scene, pieces.flats, area);
    for (size_t f = 0; f < density.size(); ++f) density[f] *= ofFar[f];
    return density;
}

// What pieces must have in common: those that are laid as one plane their surface, for walls divide planes
// into surfaces; those that share a chart the node that moves them.
enum class Common { surface, node };

// Pieces of several surfaces share a chart if their densities are nearly the same.
double commonDensity(double density, Common common) {
    constexpr double kStepsPerDoubling = 3;
    if (common == Common::surface) return density;
    return std::exp2(std::round(std::log2(density) * kStepsPerDoubling) / kStepsPerDoubling);
}

std::vector<PieceClass> classesOf(const Scene& scene, const Pieces& pieces, Common common) {
    const bool shared = common == Common::node;
    std::map<std::tuple<uint32_t, Sides, double, uint8_t>, uint32_t> kinds;
    std::vector<PieceClass> classes;
    for (uint32_t f = 0; f < pieces.flats.size(); ++f) {
        const uint32_t surface = pieces.surface(scene, f);
        const double density = commonDensity(pieces.density[f], common);
        const uint8_t sky = shared && !pieces.views.empty() ? pieces.views[f].sky : uint8_t(0);
        const auto key =
            std::make_tuple(shared ? scene.surfaces[surface].node : surface, pieces.sides[f], density, sky);
        const uint32_t kind = kinds.try_emplace(key, uint32_t(kinds.size())).first->second;
        classes.push_back({kind, pieces.aboutTexelSizeMeters / density});
    }
    return classes;
}

std::vector<ChartPlan> planCharts(std::vector<PieceGroup> groups, const std::vector<Sides>& sides,
                                  const std::vector<double>& density) {
    std::vector<ChartPlan> plans;
    for (PieceGroup& group : groups) {
        const uint32_t first = group[0].flat;
        const Common common = group.size() > 1 ? Common::node : Common::surface;
        ChartPlan plan{std::move(group), sides[first] == Sides::back, false,
                       commonDensity(density[first], common)};
        plans.push_back(plan);
        if (sides[first] != Sides::both) continue;
        plan.back = plan.twin = true;
        plans.push_back(std::move(plan));
    }
    return plans;
}

// `classes`: empty: nothing is small.
std::vector<PackBox> boxesOf(const std::vector<FlatChart>& flats, const std::vector<ChartPlan>& plans,
                             const std::vector<PieceClass>& classes) {
    std::vector<PackBox> boxes;
    for (const ChartPlan& plan : plans) {
        PackBox box;
        box.twin = plan.twin;
        const uint32_t first = plan.pieces[0].flat;
        const glm::dvec2 size = flats[first].sizeMeters;
        const bool large = classes.empty() || isLargePiece(size / classes[first].texelSizeMeters);
        if (plan.pieces.size() == 1 && large)
            box.sizeMeters = plan.density * size;
        else
            for (const LaidPiece& piece : plan.pieces)
                box.pieces.push_back(plan.density * turnedSize(flats[piece.flat].sizeMeters, piece.turns));
        boxes.push_back(std::move(box));
    }
    return boxes;
}

// Where a chart's low corner sits in its rectangle: centred, edges on texel borders; a chart narrower than a
// texel on a texel's centre, so that it has surface texels at all.
double offsetOf(double sizeTexels, uint32_t roomTexels) {
    const double offset = std::floor(0.5 * (double(roomTexels) - sizeTexels) + 1e-4);
    return sizeTexels < 1 ? offset + 0.5 - 0.5 * sizeTexels : offset;
}

struct PiecePlace {
    glm::uvec2 origin, size;          // texels
    std::optional<glm::dvec2> drawn;  // its size there, texels; as in the world if it is alone
};

// Where piece `i` of a chart has its place, gutter included.
PiecePlace placeOfPiece(const Chart& chart, const GroupLayout& layout, size_t i, bool turned) {
    if (layout.origin.empty()) return {chart.originTexel(), chart.sizeTexels(), {}};
    const glm::uvec2 origin = layout.origin[i], size = layout.size[i];
    const glm::dvec2 drawn = layout.drawn[i];
    if (!turned) return {chart.originTexel() + origin, size, drawn};
    const uint32_t height = layout.sizeTiles.y * kTileSize;
    return {chart.originTexel() + glm::uvec2(height - origin.y - size.y, origin.x),
            {size.y, size.x},
            glm::dvec2(drawn.y, drawn.x)};
}

void placePiece(Atlas& atlas, const FlatChart& flat, uint32_t chartIndex, uint32_t turns,
                const PiecePlace& place) {
    glm::dvec2 scale(1.0 / atlas.charts[chartIndex].texelSizeMeters);
    const glm::dvec2 size = scale * turnedSize(flat.sizeMeters, turns);
    glm::dvec2 low(offsetOf(size.x, place.size.x), offsetOf(size.y, place.size.y));
    if (place.drawn) {
        scale *= *place.drawn / glm::max(size, 1e-300);
        low = drawnOrigin(*place.drawn, place.size);
    }
    low += glm::dvec2(place.origin);
    for (size_t t = 0; t < flat.triangles.size(); ++t) {
        atlas.triangleChart[flat.triangles[t]] = chartIndex;
        for (int corner = 0; corner < 3; ++corner)
            atlas.triangleTexels[flat.triangles[t]][corner] =
                glm::vec2(low + scale * turnedPosition(flat.uvMeters[t][corner], flat.sizeMeters, turns));
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

Atlas placeCharts(const Scene& scene, const std::vector<FlatChart>& flats,
                  const std::vector<ChartPlan>& plans, const Packing& packing) {
    Atlas atlas;
    atlas.sizeTexels = packing.sizeTiles * kTileSize;
    atlas.texelSizeMeters = plans.empty() ? float(packing.texelSizeMeters) : 0.0f;
    atlas.triangleChart.assign(scene.triangles.size(), kNoChart);
    atlas.triangleSurface = scene.triangleSurface;
    atlas.triangleTexels.assign(scene.triangles.size(), {});
    for (uint32_t c = 0; c < plans.size(); ++c) {
        const ChartPlan& plan = plans[c];
        Chart chart;
        chart.originTile = packing.originTile[c];
        chart.sizeTiles = packing.chartTiles[c];
        chart.texelSizeMeters = float(packing.texelSizeMeters / (plan.density * packing.scale[c]));
        atlas.texelSizeMeters = std::max(atlas.texelSizeMeters, chart.texelSizeMeters);
        chart.surface = scene.triangleSurface[flats[plan.pieces[0].flat].triangles[0]];
        chart.back = plan.back;
        if (plan.twin) {
            chart.otherSide = c - 1;
            atlas.charts[c - 1].otherSide = c;
        }
        atlas.charts.push_back(chart);
        if (plan.twin) continue;
        for (size_t i = 0; i < plan.pieces.size(); ++i)
            placePiece(atlas, flats[plan.pieces[i].flat], c, plan.pieces[i].turns + packing.turned[c],
                       placeOfPiece(chart, packing.layout[c], i, packing.turned[c]));
    }
    fillTileTable(atlas);
    numberBlocks(atlas);
    return atlas;
}

// Occupied fraction of the atlas; the scenes in scenes/ reach .74 to .90.
constexpr double kUsualCoverage = 0.75;
// Texel sizes so near each other ask for the same groups of pieces.
constexpr double kSameSize = 1.15;

// About the texel size that will come out, before anything is packed.
double guessTexelSize(const MeshTopology& topology, const AtlasSettings& settings) {
    if (settings.texelSizeMeters > 0) return settings.texelSizeMeters;
    double area = 0;
    for (const double a : topology.faceArea) area += a;
    return std::sqrt(area / (kUsualCoverage * double(std::max<uint64_t>(settings.texelBudget, 1))));
}

// The same once it is known what has texels.
double aboutTexelSize(const std::vector<FlatChart>& flats, const std::vector<Sides>& sides,
                      const std::vector<double>& density, const AtlasSettings& settings) {
    if (settings.texelSizeMeters > 0) return settings.texelSizeMeters;
    double area = 0;
    for (size_t f = 0; f < flats.size(); ++f) area += litArea(flats[f], sides[f]) * density[f] * density[f];
    return std::sqrt(area / (kUsualCoverage * double(std::max<uint64_t>(settings.texelBudget, 1))));
}

template <typename Value>
std::vector<Value> ofMembers(const std::vector<Value>& values, const std::vector<uint32_t>& member) {
    std::vector<Value> result;
    for (const uint32_t m : member) result.push_back(values[m]);
    return result;
}

// Texels a side at which a UV set is searched for overlaps: about the size of the atlas.
uint32_t checkResolutionFor(const MeshTopology& topology, double texelSizeMeters) {
    double area = 0;
    for (const double a : topology.faceArea) area += a;
    // At least 512: a small budget must not hide overlaps behind coarse texels.
    return uint32_t(std::clamp(std::sqrt(area) / std::max(texelSizeMeters, 1e-30), 512.0, 8192.0));
}

void takeJoined(Pieces& pieces, const Scene& scene, const MeshTopology& topology, uint32_t gutterTexels) {
    const std::vector<PieceClass> classes = classesOf(scene, pieces, Common::surface);
    JoinedPieces joined = joinCoplanar(scene, topology, std::move(pieces.flats), classes, gutterTexels);
    pieces.flats = std::move(joined.flats);
    pieces.sides = ofMembers(pieces.sides, joined.member);
    pieces.density = ofMembers(pieces.density, joined.member);
}

// What buildAtlas is asked for. `rays`: null: all pieces count as open.
struct AtlasOrder {
    const Scene& scene;
    const RayScene* rays;
    const std::vector<Sides>& componentSides;
    const AtlasSettings& settings;
};

Pieces makePieces(const AtlasOrder& order, const MeshTopology& topology, Progress& progress) {
    const auto& [scene, rays, componentSides, settings] = order;
    const double texelSize = guessTexelSize(topology, settings);
    Pieces pieces;
    pieces.flats = settings.useUvSet >= 0 ? chartsFromUvSet(scene, topology, settings.useUvSet,
                                                            checkResolutionFor(topology, texelSize), progress)
                                          : unwrapScene(scene, topology, settings.maxNormalConeDegrees,
                                                        {texelSize, settings.gutterTexels}, progress);
    pieces.sides = chooseSides(scene, pieces.flats, componentSides);
    pieces.density = chooseDensities(scene, pieces, settings);
    pieces.aboutTexelSizeMeters = aboutTexelSize(pieces.flats, pieces.sides, pieces.density, settings);
    if (settings.useUvSet < 0) takeJoined(pieces, scene, topology, settings.gutterTexels);
    if (!rays) return pieces;
    const std::vector<uint32_t> component =
        componentSides.empty() ? std::vector<uint32_t>() : connectedComponents(scene);
    pieces.views = viewsOfPieces(*rays, {pieces.flats, pieces.sides, component, componentSides},
                                 pieces.aboutTexelSizeMeters, progress);
    if (settings.texelSizeMeters > 0) return pieces;
    for (size_t f = 0; f < pieces.views.size(); ++f)
        if (pieces.views[f].hidden) pieces.density[f] *= kHiddenDensity;
    pieces.aboutTexelSizeMeters = aboutTexelSize(pieces.flats, pieces.sides, pieces.density, settings);
    return pieces;
}

Atlas buildAtlasOf(const AtlasOrder& order, Progress& progress, AtlasStats* stats) {
    const auto& [scene, rays, componentSides, settings] = order;
    if (!(settings.glossyDensity >= 1 && settings.glossyDensity <= kMaxGlossyDensity))
        throw std::invalid_argument("the density of glossy surfaces must be from 1 to 8");
    progress.begin("unwrap", scene.triangles.size());
    const MeshTopology topology = buildTopology(scene);
    Pieces pieces = makePieces(order, topology, progress);
    std::vector<ChartPlan> plans;
    Packing packing;
    // Which pieces are small depends on the texels' size, which depends on how many are.
    for (int round = 0; round < 3; ++round) {
        const std::vector<PieceClass> classes = classesOf(scene, pieces, Common::node);
        const bool given = settings.useUvSet >= 0;  // islands of a UV set stay as they are
        plans = planCharts(
            given ? alone(pieces.flats.size())
                  : groupPieces(scene, topology, pieces.flats, classes, settings.gutterTexels, progress),
            pieces.sides, pieces.density);
        packing = packCharts(boxesOf(pieces.flats, plans, given ? std::vector<PieceClass>() : classes),
                             settings, progress);
        const double off = packing.texelSizeMeters / pieces.aboutTexelSizeMeters;
        if (settings.texelSizeMeters > 0 || plans.empty() || (off < kSameSize && off > 1 / kSameSize)) break;
        pieces.aboutTexelSizeMeters = packing.texelSizeMeters;
    }
    if (plans.empty() && !scene.triangles.empty()) {
        // Triangles without area have no charts but stay in the file: one tile without a chart holds their
        // UVs.
        packing.texelSizeMeters = 1;
        packing.sizeTiles = glm::uvec2(1);
    }
    Atlas atlas = placeCharts(scene, pieces.flats, plans, packing);
    atlas.unitMeters = lengthUnit(scene);
    progress.end();
    if (stats) *stats = statsOf(atlas, pieces.flats, topology);
    return atlas;
}

}  // namespace

Atlas buildAtlas(const Scene& scene, const std::vector<Sides>& componentSides, const AtlasSettings& settings,
                 Progress& progress, AtlasStats* stats) {
    return buildAtlasOf({scene, nullptr, componentSides, settings}, progress, stats);
}

Atlas buildAtlas(const RayScene& rays, const std::vector<Sides>& componentSides,
                 const AtlasSettings& settings, Progress& progress, AtlasStats* stats) {
    return buildAtlasOf({rays.scene(), &rays, componentSides, settings}, progress, stats);
}

}  // namespace phat
