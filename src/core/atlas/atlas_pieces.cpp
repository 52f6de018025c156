#include "core/atlas/atlas_pieces.h"

#include <cassert>
#include <cmath>
#include <map>
#include <tuple>

#include "core/atlas/far_density.h"
#include "core/atlas/glossy_density.h"
#include "core/atlas/join_coplanar.h"

namespace phat {
namespace {

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

// That with which a piece has as many texels as with those of its triangles.
double meanDensity(const std::vector<double>& ofTriangle, const MeshTopology& topology,
                   const FlatChart& flat) {
    double texels = 0, area = 0;
    for (const uint32_t t : flat.triangles) {
        texels += topology.faceArea[t] * ofTriangle[t] * ofTriangle[t];
        area += topology.faceArea[t];
    }
    return area > 0 ? std::sqrt(texels / area) : 1;
}

// Per flat piece.
std::vector<double> chooseDensities(const AtlasOrder& order, const MeshTopology& topology,
                                    const Pieces& pieces) {
    const Scene& scene = order.scene;
    const AtlasSettings& settings = order.settings;
    const std::vector<float> ofSurface = glossyDensities(scene, settings.glossyDensity);
    std::vector<double> area, density;
    for (uint32_t f = 0; f < pieces.flats.size(); ++f) {
        area.push_back(litArea(pieces.flats[f], pieces.sides[f]));
        density.push_back(double(ofSurface[pieces.surface(scene, f)]));
    }
    if (settings.texelSizeMeters > 0) return density;
    if (order.farDensity) {
        for (size_t f = 0; f < density.size(); ++f)
            density[f] *= meanDensity(*order.farDensity, topology, pieces.flats[f]);
        return density;
    }
    keepBudget(area, density);
    const std::vector<double> ofFar = farDensities(scene, pieces.flats, area);
    for (size_t f = 0; f < density.size(); ++f) density[f] *= ofFar[f];
    return density;
}

// Occupied fraction of the atlas; the scenes in scenes/ reach .74 to .90.
constexpr double kUsualCoverage = 0.75;

// About the texel size that will come out, before anything is packed.
double guessTexelSize(const AtlasOrder& order, const MeshTopology& topology) {
    if (order.texelSizeMeters > 0) return order.texelSizeMeters;
    double area = 0;
    for (const double a : topology.faceArea) area += a;
    return std::sqrt(area / (kUsualCoverage * double(std::max<uint64_t>(order.settings.texelBudget, 1))));
}

// The same once it is known what has texels.
double aboutTexelSize(const AtlasOrder& order, const Pieces& pieces) {
    if (order.texelSizeMeters > 0) return order.texelSizeMeters;
    double area = 0;
    for (size_t f = 0; f < pieces.flats.size(); ++f)
        area += litArea(pieces.flats[f], pieces.sides[f]) * pieces.density[f] * pieces.density[f];
    return std::sqrt(area / (kUsualCoverage * double(std::max<uint64_t>(order.settings.texelBudget, 1))));
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

}  // namespace

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

Pieces makePieces(const AtlasOrder& order, const MeshTopology& topology, Progress& progress) {
    const auto& [scene, rays, componentSides, settings, given, farDensity] = order;
    const double texelSize = guessTexelSize(order, topology);
    Pieces pieces;
    pieces.flats = settings.useUvSet >= 0 ? chartsFromUvSet(scene, topology, settings.useUvSet,
                                                            checkResolutionFor(topology, texelSize), progress)
                                          : unwrapScene(scene, topology, settings.maxNormalConeDegrees,
                                                        {texelSize, settings.gutterTexels}, progress);
    pieces.sides = chooseSides(scene, pieces.flats, componentSides);
    pieces.density = chooseDensities(order, topology, pieces);
    pieces.aboutTexelSizeMeters = aboutTexelSize(order, pieces);
    if (settings.useUvSet < 0) takeJoined(pieces, scene, topology, settings.gutterTexels);
    if (!rays) return pieces;
    const std::vector<uint32_t> component =
        componentSides.empty() ? std::vector<uint32_t>() : connectedComponents(scene);
    pieces.views = viewsOfPieces(*rays, {pieces.flats, pieces.sides, component, componentSides},
                                 pieces.aboutTexelSizeMeters, progress);
    if (settings.texelSizeMeters > 0) return pieces;
    for (size_t f = 0; f < pieces.views.size(); ++f)
        if (pieces.views[f].hidden) pieces.density[f] *= kHiddenDensity;
    pieces.aboutTexelSizeMeters = aboutTexelSize(order, pieces);
    return pieces;
}

}  // namespace phat
