// The bake: its rays against bare Embree, its stages, its memory.

#include <fstream>

#include "bench_scene.h"
#include "core/bake/gather.h"
#include "core/bake/irradiance_ray.h"
#include "core/base/parallel.h"

namespace phat {
namespace {

// Everything that gathering reads, kept alive together.
struct GatherSetup {
    explicit GatherSetup(const BakeSettings& bakeSettings) : settings(bakeSettings) {}

    BakeSettings settings;
    SilentProgress progress;
    Scene scene = benchScene("tabletop");
    RayScene rays{scene};
    LightSampler lights{scene};
    PhotonMap photons = tracePhotons(rays, lights, settings.photons, progress);
    PhotonIndex index{photons.photons};
    Atlas atlas = buildAtlas(scene, {}, settings.atlas, progress);
    TexelPoints points = buildTexelPoints(scene, atlas);
    std::vector<Frame> frames = blockFrames(atlas, points);
    std::vector<uint8_t> receives = irradianceTexels(atlas, points);
    GatherInput input{rays, lights, atlas, points, frames, photons, index, receives};
    std::vector<Guide> guides =
        buildGuides({atlas, points, frames}, {photons, index}, isIndirectPhoton, progress);
    ChosenDirections chosen = chooseGuidedDirections(
        {atlas, points, frames}, guides, {Directions::guided, settings.density, settings.seed, 0}, progress);
};

// `count` rays in the order of gathering: each texel's own, then diffuse bounces from its hit in chains as
// long as what gathering traces for a texel on average.
std::vector<Ray> recordRays(const GatherSetup& setup, uint64_t count) {
    std::vector<size_t> texels;
    for (size_t i = 0; i < setup.atlas.texelCount(); ++i)
        if (setup.points.valid(i) && setup.chosen.pdf[i] > 0) texels.push_back(i);
    std::vector<Ray> recorded;
    recorded.reserve(count);
    for (size_t k = 0; k < texels.size(); ++k) {
        const size_t texel = texels[k];
        const glm::uvec2 xy(texel % setup.atlas.sizeTexels.x, texel / setup.atlas.sizeTexels.x);
        const Frame& frame = setup.frames[setup.atlas.blockAt(xy)];
        Rng rng(texel);
        Ray ray{setup.rays.offsetOrigin(setup.points.position[texel], setup.points.normal[texel]),
                glm::normalize(frame.toWorld(setup.chosen.directionBlock[texel]))};
        const Ray primary = ray;
        for (const size_t end = count * (k + 1) / texels.size(); recorded.size() < end;) {
            recorded.push_back(ray);
            const Hit hit = setup.rays.closestHit(ray.origin, ray.direction);
            if (!hit) {
                ray = primary;
                continue;
            }
            const SurfacePoint point = surfaceAt(setup.scene, hit, ray.direction);
            ray.origin = setup.rays.offsetOrigin(point.position, point.normalGeometric);
            ray.direction =
                frameFromNormal(point.normalGeometric).toWorld(squareToCosineHemisphere(rng.uniform2()));
        }
    }
    return recorded;
}

// Argument: paths a PHATexel.
void gatherAgainstEmbree(benchmark::State& state) {
    BakeSettings settings;
    settings.atlas.texelBudget = 50'000;
    settings.photons.count = 100'000;
    settings.pathsPerPhatexel = int(state.range(0));
    settings.radiance = RadianceSource::path;
    GatherSetup setup(settings);

    const std::vector<uint32_t> noIrradiance;
    double gatherSeconds = 0, embreeSeconds = 0;
    uint64_t rays = 0;
    for (auto _ : state) {
        std::atomic<uint64_t> rayCount = 0;
        gatherSeconds += secondsOf([&] {
            benchmark::DoNotOptimize(
                gatherIndirect({setup.input, settings, setup.progress, nullptr, rayCount}, setup.chosen,
                               {noIrradiance, noIrradiance}, 0));
        });
        rays += rayCount;
        const std::vector<Ray> recorded = recordRays(setup, rayCount);
        embreeSeconds += secondsOf([&] {
            parallelRanges(recorded.size(), 16'384, setup.progress, [&](size_t begin, size_t end) {
                for (size_t i = begin; i < end; ++i)
                    benchmark::DoNotOptimize(
                        setup.rays.closestHit(recorded[i].origin, recorded[i].direction));
            });
        });
    }
    state.counters["rays_per_second"] = double(rays) / gatherSeconds;
    state.counters["embree_rays_per_second"] = double(rays) / embreeSeconds;
    state.counters["share_of_embree"] = embreeSeconds / gatherSeconds;
}
BENCHMARK(gatherAgainstEmbree)->Arg(1)->Arg(8)->Unit(benchmark::kSecond)->UseRealTime()->Iterations(1);

// Linux: from here on VmHWM is the largest resident size since the call.
void resetPeakMemory() {
    std::ofstream("/proc/self/clear_refs") << 5;
}

double peakMemoryBytes() {
    std::ifstream status("/proc/self/status");
    for (std::string word; status >> word;) {
        if (word != "VmHWM:") continue;
        double kilobytes = 0;
        status >> kilobytes;
        return 1024 * kilobytes;
    }
    return 0;
}

// Argument: texels of the atlas.
void bakeTabletop(benchmark::State& state) {
    BakeSettings settings;
    settings.atlas.texelBudget = uint64_t(state.range(0));
    const Scene scene = benchScene("tabletop");
    StageClock clock;
    resetPeakMemory();
    uint64_t texels = 0;
    for (auto _ : state) texels = bake(scene, settings, clock).stats.texels;
    for (const auto& [stage, seconds] : clock.seconds) state.counters["seconds " + stage] = seconds;
    state.counters["texels"] = double(texels);
    state.counters["peak_bytes"] = peakMemoryBytes();
    state.counters["estimated_bytes"] = double(estimateBakeMemory(scene, settings));
}
BENCHMARK(bakeTabletop)->Arg(1'048'576)->Unit(benchmark::kSecond)->UseRealTime()->Iterations(1);

}  // namespace
}  // namespace phat
