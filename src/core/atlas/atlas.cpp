#include "core/atlas/atlas.h"

#include <stdexcept>

#include "core/atlas/atlas_pack.h"
#include "core/atlas/atlas_plan.h"
#include "core/atlas/atlas_stats.h"
#include "core/atlas/glossy_density.h"
#include "core/scene/length_unit.h"

namespace phat {
namespace {

// Texel sizes so near each other ask for the same groups of pieces.
constexpr double kSameSize = 1.15;

Atlas buildAtlasOf(const AtlasOrder& order, Progress& progress, AtlasStats* stats) {
    const auto& [scene, rays, componentSides, settings, given, farDensity] = order;
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
        const bool asIslands = settings.useUvSet >= 0;  // islands of a UV set stay as they are
        plans = planCharts(
            asIslands ? alone(pieces.flats.size())
                      : groupPieces(scene, topology, pieces.flats, classes, settings.gutterTexels, progress),
            pieces);
        packing = packCharts(boxesOf(pieces, plans, asIslands ? std::vector<PieceClass>() : classes),
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
    Atlas atlas = placeCharts(scene, pieces, plans, packing);
    atlas.unitMeters = lengthUnit(scene);
    progress.end();
    if (stats) *stats = statsOf(atlas, pieces.flats, topology);
    return atlas;
}

}  // namespace

Atlas buildAtlas(const Scene& scene, const std::vector<Sides>& componentSides, const AtlasSettings& settings,
                 Progress& progress, AtlasStats* stats) {
    return buildAtlasOf({scene, nullptr, componentSides, settings, settings.texelSizeMeters}, progress,
                        stats);
}

Atlas buildAtlas(const RayScene& rays, const std::vector<Sides>& componentSides,
                 const AtlasSettings& settings, Progress& progress, AtlasStats* stats) {
    return buildAtlasOf({rays.scene(), &rays, componentSides, settings, settings.texelSizeMeters}, progress,
                        stats);
}

}  // namespace phat
