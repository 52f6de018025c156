#include "core/bake/bake.h"

#include <stdexcept>

#include "core/atlas/atlas_stats.h"
#include "core/atlas/glossy_density.h"
#include "core/atlas/texel_point_bytes.h"
#include "core/bake/gather.h"
#include "core/bake/indirect_irradiance.h"
#include "core/bake/irradiance_finish.h"
#include "core/bake/irradiance_ray.h"
#include "core/bake/visible_sides.h"
#include "core/base/stopwatch.h"
#include "core/phatexel/directions.h"
#include "core/phatexel/lookup_tables.h"
#include "core/phatexel/photon_directions.h"
#include "core/scene/lights.h"

namespace phat {
namespace {

std::vector<Guide> guidesFor(const GatherInput& input, Directions strategy, PhotonFilter keep,
                             Progress& progress) {
    if (input.atlas.blockCount == 0) return {uniformGuide()};  // no surface has an area
    switch (strategy) {
        case Directions::uniform:
            return {uniformGuide()};
        case Directions::cosine:
            return {cosineGuide()};
        default: {
            ProgressStage stage(progress, "guides", input.atlas.blockCount);
            return buildGuides(input.blocks(), {input.photons, input.index}, keep, progress);
        }
    }
}

ChosenDirections directionsFor(const GatherInput& input, const std::vector<Guide>& guides, PhotonFilter keep,
                               const DirectionSettings& settings, Progress& progress) {
    ProgressStage stage(
        progress, "directions",
        choosesPhotons(settings.strategy) ? input.atlas.blockCount : input.atlas.texelCount());
    if (choosesPhotons(settings.strategy))
        return choosePhotonDirections(input.blocks(), {input.photons, input.index}, keep, settings, progress);
    return chooseGuidedDirections(input.blocks(), guides, settings, progress);
}

void bakeIndirect(const GatherContext& context, Phatexture& out) {
    const GatherInput& input = context.input;
    const BakeSettings& settings = context.settings;
    out.indirectGuides = guidesFor(input, settings.directions, isIndirectPhoton, context.progress);
    for (int layer = 0; layer < settings.layers; ++layer) {
        ChosenDirections chosen = directionsFor(input, out.indirectGuides, isIndirectPhoton,
                                                {settings.directions, settings.density, settings.seed, layer,
                                                 settings.radiance == RadianceSource::splat},
                                                context.progress);
        ProgressStage stage(context.progress, "indirect light", input.atlas.texelCount());
        out.indirect.push_back(
            gatherIndirect(context, chosen, {out.indirectIrradiance, out.areaIrradiance}, layer));
        if (choosesPhotons(settings.directions)) out.indirect.back().pdf = std::move(chosen.pdf);
        out.indirect.back().scrambles = std::move(chosen.scrambles);
    }
}

void bakeAreaPhatexels(const GatherContext& context, Phatexture& out) {
    const GatherInput& input = context.input;
    const BakeSettings& settings = context.settings;
    out.areaGuides = guidesFor(input, Directions::guided, isAreaPhoton, context.progress);
    // Layer -1: a stream of its own, whatever the number of indirect layers.
    ChosenDirections chosen =
        directionsFor(input, out.areaGuides, isAreaPhoton,
                      {Directions::guided, settings.density, settings.seed, -1}, context.progress);
    ProgressStage stage(context.progress, "area light", input.atlas.texelCount());
    out.area.push_back(gatherArea(context, chosen));
    out.area.back().scrambles = std::move(chosen.scrambles);
}

std::vector<uint32_t> bakeAreaIrradiance(const GatherContext& context, const std::vector<SeamPoint>& seams) {
    const GatherInput& input = context.input;
    ProgressStage stage(context.progress, "soft shadows",
                        2 * input.atlas.texelCount());  // all texels, then the hard ones
    const std::vector<IrradianceEstimate> estimates = gatherAreaIrradiance(context);
    IrradianceMap filtered;
    const ChartSet all;
    finish(filterAreaIrradiance(estimates, input.receivers(), all, filtered, kNoSlicing));
    return finishAreaIrradiance(std::move(filtered), input, seams, context.progress);
}

void bakeAreaLight(const GatherContext& context, const std::vector<SeamPoint>& seams, Phatexture& out) {
    if (!context.input.lights.hasArea() && !context.settings.dynamic) return;
    if (const Phatexture* same = context.same.areaLight) {
        out.areaGuides = same->areaGuides;
        out.area = same->area;
    } else {
        bakeAreaPhatexels(context, out);
    }
    const Phatexture* same = context.same.areaIrradiance;
    out.areaIrradiance = same ? same->areaIrradiance : bakeAreaIrradiance(context, seams);
}

}  // namespace

Phatexture gatherLight(const GatherContext& context) {
    const GatherInput& input = context.input;
    Phatexture result;
    const std::vector<SeamPoint> seams = findSeams(input.rays.scene(), input.atlas);
    bakeAreaLight(context, seams, result);
    result.indirectIrradiance = finishIndirectIrradiance(
        gatherIndirectIrradiance(context, result.areaIrradiance), input, seams, context.progress);
    bakeIndirect(context, result);
    if (const Phatexture* same = context.same.distances) {
        result.probes = same->probes;
        packTiles(result, input.atlas, fitTilePatches(input.atlas, input.points, input.frames), input.frames);
    } else {
        prepareLookup(result, input.atlas, input.points, input.frames, input.rays, context.progress);
    }
    return result;
}

namespace {

uint64_t validPhatexels(const std::vector<PhatexelLayer>& layers) {
    uint64_t count = 0;
    for (const PhatexelLayer& layer : layers)
        for (const PackedPhatexel packed : layer.texels) count += packed.directionDistance != 0;
    return count;
}

// Whether all surfaces are those of the earlier bake, in the same order.
bool sameSurfaces(const EarlierCharts& charts) {
    if (charts.earlierSurface.size() != charts.surfaces.size()) return false;
    for (uint32_t s = 0; s < charts.earlierSurface.size(); ++s)
        if (charts.earlierSurface[s] != s) return false;
    return true;
}

// The results of an earlier bake of the same scene.
void takeAll(const Scene& scene, const EarlierBake& earlier, Bake& out) {
    out.atlas = earlier.charts.atlas;
    out.points = earlier.results->points;
    out.phatexture = earlier.results->phatexture;
    out.keys = earlier.results->keys;
    out.stats.atlas = statsOf(out.atlas, {}, buildTopology(scene));
    out.stats.atlas.keptCharts = out.stats.atlas.chartCount;
    out.stats.kept = {
        true, validPhatexels(out.phatexture.indirect) + validPhatexels(out.phatexture.area), {"all light"}};
}

void makeAtlas(const LitScene& scene, const PhotonMap& photons, const BakeSettings& settings,
               const EarlierBake* earlier, Progress& progress, Bake& out) {
    AtlasStats* stats = &out.stats.atlas;
    const auto sidesOf = settings.dynamic ? visibleSides : litSides;
    if (!earlier) {
        out.atlas = buildAtlas(scene.rays, sidesOf(scene, photons, nullptr), settings.atlas, progress, stats);
        return;
    }
    EarlierCharts charts = earlier->charts;
    const std::vector<Sides> sides = sidesOf(scene, photons, &charts.needed);
    out.atlas = buildAtlasOn(charts, scene.rays, sides, settings.atlas, progress, stats);
}

// Texels and what of them is occluded. pre: the key of the geometry is known.
void makeTexels(const LitScene& scene, const EarlierBake* earlier, Progress& progress, Bake& out) {
    out.points = buildTexelPoints(scene.rays.scene(), out.atlas);
    if (!earlier || !earlier->results || !sameKey(out.keys.geometry, earlier->results->keys.geometry))
        return markOccludedTexels(out.points, out.atlas, scene.rays, progress);
    out.points.state = earlier->results->points.state;
    out.stats.kept.stages.emplace_back("find occluded texels");
}

uint64_t countDarkTexels(const LitScene& scene, const PhotonMap& photons, const Bake& bake) {
    const Components components = findComponents(scene.rays.scene());
    const std::vector<Sides> lit = litSides(scene, photons);
    uint64_t dark = 0;
    for (size_t i = 0; i < bake.points.state.size(); ++i) {
        if (!bake.points.valid(i)) continue;
        const bool back = bake.atlas.charts[bake.atlas.chartAt(i)].back;
        dark += lit[components.ofTriangle[bake.points.triangle[i]]] == (back ? Sides::front : Sides::back);
    }
    return dark;
}

// What of the light is that of the earlier bake, by the keys of this one.
SameLight sameLight(const EarlierBake* earlier, const StageKeys& keys, KeptParts& kept) {
    SameLight same;
    if (!earlier || !earlier->results) return same;
    const EarlierResults& before = *earlier->results;
    const Phatexture* phatexture = &before.phatexture;
    if (sameKey(keys.areaLight, before.keys.areaLight) && !phatexture->area.empty()) {
        same.areaLight = phatexture;
        kept.stages.emplace_back("area light");
        kept.phatexels = validPhatexels(phatexture->area);
    }
    if (sameKey(keys.areaIrradiance, before.keys.areaIrradiance) && !phatexture->areaIrradiance.empty()) {
        same.areaIrradiance = phatexture;
        kept.stages.emplace_back("soft shadows");
    }
    if (sameKey(keys.geometry, before.keys.geometry) && !phatexture->probes.empty()) {
        same.distances = phatexture;
        kept.stages.emplace_back("distances");
    }
    return same;
}

}  // namespace

Bake bake(const RayScene& rays, const BakeSettings& settings, Progress& progress, BakeJournal* journal,
          const EarlierBake* earlier) {
    if (settings.radiance == RadianceSource::splat && !choosesPhotons(settings.directions))
        throw std::invalid_argument("splatted radiance needs directions from photons");
    const Stopwatch start;
    Bake result;
    std::atomic<uint64_t> rayCount = 0;
    const SceneKeys sceneKeys(rays.scene());
    result.keys.all = sceneKeys.ofAll(settings);
    if (earlier && earlier->results && sameKey(result.keys.all, earlier->results->keys.all) &&
        sameSurfaces(earlier->charts)) {
        takeAll(rays.scene(), *earlier, result);
    } else {
        const LightSampler lights(rays.scene());
        const PhotonMap photons = tracePhotons(rays, lights, settings.photons, progress);
        const PhotonIndex index(photons.photons);
        makeAtlas({rays, lights}, photons, settings, earlier, progress, result);
        StageKeys& keys = result.keys;
        keys.geometry = sceneKeys.ofGeometry(result.atlas);
        makeTexels({rays, lights}, earlier, progress, result);
        if (settings.dynamic) result.stats.darkTexels = countDarkTexels({rays, lights}, photons, result);
        keys.areaIrradiance = sceneKeys.ofAreaIrradiance(keys.geometry, settings);
        keys.areaLight = keyOfAreaLight(keys.areaIrradiance, photons, settings);
        const std::vector<Frame> frames = blockFrames(result.atlas, result.points);
        const std::vector<uint8_t> receivers = irradianceTexels(result.atlas, result.points);
        const GatherInput input{rays, lights, result.atlas, result.points, frames, photons, index, receivers};
        GatherContext context{input, settings, progress, journal, rayCount};
        context.same = sameLight(earlier, keys, result.stats.kept);
        result.phatexture = gatherLight(context);
        result.stats.photons = photons.stats;
    }
    result.stats.texels = result.atlas.texelCount();
    result.stats.validPhatexels = validPhatexels(result.phatexture.indirect);
    result.stats.rays = rayCount;
    result.stats.seconds = start.seconds();
    return result;
}

namespace {

double expectedTexels(const Scene& scene, const AtlasSettings& atlas) {
    // Packing and gutters take up to half as much again.
    constexpr double kPacking = 1.5;
    if (!(atlas.texelSizeMeters > 0.0f)) return kPacking * double(atlas.texelBudget);
    const std::vector<float> density = glossyDensities(scene, atlas.glossyDensity);
    double area = 0;  // as if all texels were of the given size
    for (size_t i = 0; i < scene.triangles.size(); ++i) {
        const glm::uvec3& t = scene.triangles[i];
        area += 0.5 * square(density[scene.triangleSurface[i]]) *
                glm::length(glm::cross(scene.positions[t.y] - scene.positions[t.x],
                                       scene.positions[t.z] - scene.positions[t.x]));
    }
    return kPacking * area / (double(atlas.texelSizeMeters) * atlas.texelSizeMeters);
}

// Photons that will be stored: the mean of some of them, and four standard errors of the parts that they are
// traced in.
double expectedPhotons(const RayScene& rays, const PhotonSettings& settings) {
    constexpr uint64_t kParts = 16, kPartPhotons = 1024;
    const LightSampler lights(rays.scene());
    SilentProgress silent;
    double sum = 0, squares = 0;
    uint64_t parts = 0;
    for (; parts < kParts && parts * kPartPhotons < settings.count; ++parts) {
        const uint64_t begin = parts * kPartPhotons, end = std::min(begin + kPartPhotons, settings.count);
        const double stored =
            double(tracePhotonPart(rays, lights, settings, begin, end, silent).photons.size());
        sum += stored;
        squares += stored * stored;
    }
    const double traced = double(std::min(parts * kPartPhotons, settings.count));
    if (parts < kParts) return sum;  // all of them
    const double mean = sum / double(parts);
    const double error = std::sqrt(std::max(0.0, squares / double(parts) - mean * mean) / double(parts - 1));
    return (sum + 4 * double(parts) * error) * double(settings.count) / traced;
}

}  // namespace

uint64_t estimateBakeMemory(const Scene& scene, const BakeSettings& settings) {
    const RayScene rays(scene);
    constexpr double kTileTexels = kTileSize * kTileSize, kBlockTexels = kBlockSize * kBlockSize;
    constexpr double kNodeTexels = kLevelSteps[0] * kLevelSteps[0];
    constexpr double kDirections = 2 * sizeof(glm::vec3) + sizeof(float);  // of ChosenDirections
    // In cluttered rooms nearly every other group of four texels has a finer node that keeps its rays.
    constexpr double kIndirectIrradiance =
        sizeof(NodeRays) / kNodeTexels + sizeof(FineNodeRays) / 8.0 + 2 * sizeof(glm::vec3);
    constexpr double kAreaLight = sizeof(PackedPhatexel) + sizeof(uint32_t);  // a layer, a map
    constexpr double kTables =
        2 * sizeof(Guide) / kBlockTexels + (sizeof(DepthProbe) + sizeof(PackedTile)) / kTileTexels;
    const double stored = kAreaLight + kTables + sizeof(uint32_t) + sizeof(PackedPhatexel) * settings.layers;
    const double result = double(kTexelPointBytes) + stored;
    // Irradiance is gathered before directions are chosen: the larger of the two counts.
    const double gathered = result + std::max(kDirections, kIndirectIrradiance);
    // As payloads, compressed, in the file's chunk, and in the file.
    const double written = result + 4 * stored;
    // The batches that photons are traced in, while they are put together; later the tree over them.
    constexpr double kPhotonBytes = sizeof(Photon) + 32;
    // Of a sky: how it is sampled; later packed, as a payload, and compressed.
    constexpr double kSkyBytes = 12;
    const double sky = scene.environment ? kSkyBytes * double(scene.environment->radiance.pixels.size()) : 0;
    const double texels = expectedTexels(scene, settings.atlas);
    const double photons = kPhotonBytes * expectedPhotons(rays, settings.photons);
    // The unwrapper's topology.
    const double sceneBytes = 700.0 * double(scene.triangles.size());
    constexpr double kFixed = 12e6;
    // Photons are gone when the file is written.
    return uint64_t(std::max(texels * gathered + photons, texels * written) + sky + sceneBytes + kFixed);
}

}  // namespace phat
