#include "core/bake/bake.h"

#include <stdexcept>

#include "core/atlas/glossy_density.h"
#include "core/atlas/texel_point_bytes.h"
#include "core/bake/gather.h"
#include "core/bake/indirect_irradiance.h"
#include "core/bake/irradiance_finish.h"
#include "core/bake/irradiance_ray.h"
#include "core/bake/lit_sides.h"
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

void bakeAreaLight(const GatherContext& context, const std::vector<SeamPoint>& seams, Phatexture& out) {
    const GatherInput& input = context.input;
    const BakeSettings& settings = context.settings;
    if (!input.lights.hasArea()) return;
    out.areaGuides = guidesFor(input, Directions::guided, isAreaPhoton, context.progress);
    // Layer -1: a stream of its own, whatever the number of indirect layers.
    ChosenDirections chosen =
        directionsFor(input, out.areaGuides, isAreaPhoton,
                      {Directions::guided, settings.density, settings.seed, -1}, context.progress);
    {
        ProgressStage stage(context.progress, "area light", input.atlas.texelCount());
        out.area.push_back(gatherArea(context, chosen));
        out.area.back().scrambles = std::move(chosen.scrambles);
    }
    ProgressStage stage(context.progress, "soft shadows",
                        2 * input.atlas.texelCount());  // all texels, then the hard ones
    const std::vector<IrradianceEstimate> estimates = gatherAreaIrradiance(context);
    IrradianceMap filtered;
    const ChartSet all;
    finish(filterAreaIrradiance(estimates, input.receivers(), all, filtered, kNoSlicing));
    out.areaIrradiance = finishAreaIrradiance(std::move(filtered), input, seams, context.progress);
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
    prepareLookup(result, input.atlas, input.points, input.frames, input.rays, context.progress);
    return result;
}

Bake bake(const RayScene& rays, const BakeSettings& settings, Progress& progress, BakeJournal* journal) {
    if (settings.radiance == RadianceSource::splat && !choosesPhotons(settings.directions))
        throw std::invalid_argument("splatted radiance needs directions from photons");
    const Stopwatch start;
    Bake result;
    const LightSampler lights(rays.scene());

    const PhotonMap photons = tracePhotons(rays, lights, settings.photons, progress);
    const PhotonIndex index(photons.photons);
    result.atlas =
        buildAtlas(rays, litSides({rays, lights}, photons), settings.atlas, progress, &result.stats.atlas);
    result.points = buildTexelPoints(rays.scene(), result.atlas);
    markOccludedTexels(result.points, result.atlas, rays, progress);
    const std::vector<Frame> frames = blockFrames(result.atlas, result.points);
    const std::vector<uint8_t> receivers = irradianceTexels(result.atlas, result.points);
    const GatherInput input{rays, lights, result.atlas, result.points, frames, photons, index, receivers};

    std::atomic<uint64_t> rayCount = 0;
    result.phatexture = gatherLight({input, settings, progress, journal, rayCount});

    result.stats.photons = photons.stats;
    result.stats.texels = result.atlas.texelCount();
    for (const PhatexelLayer& layer : result.phatexture.indirect)
        for (PackedPhatexel packed : layer.texels)
            result.stats.validPhatexels += packed.directionDistance != 0;
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
    // At most one finer node in each group of four texels keeps its rays.
    constexpr double kIndirectIrradiance =
        sizeof(NodeRays) / kNodeTexels + sizeof(FineNodeRays) / 4.0 + 2 * sizeof(glm::vec3);
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
