#include "core/gather.h"

#include <cstring>

#include "core/parallel.h"

namespace phat {
namespace {

// Texels a part: 16 or 32 kB, so that a record of the journal outweighs its header and the wait for the disk.
constexpr size_t kPartTexels = 2048;

enum class Stage : uint64_t { indirect = 1, area = 2, areaIrradiance = 3, moreAreaIrradiance = 4 };

// Rounds of light samples for every texel, and further ones for those in penumbrae or noise.
constexpr int kFirstRounds = 2, kFurtherRounds = 6;
// Standard errors below this share need no further rounds: the filter removes them.
constexpr float kQuietRelativeError = 0.02f;

// Fills `values` by fillOne(index, rays) in parts; parts that the journal has are not computed again. With
// many paths a part takes seconds: a stop is noticed between texels, and the unfinished part is dropped.
template <typename Value, typename FillOne>
void fillParts(std::vector<Value>& values, uint64_t key, Progress& progress, BakeJournal* journal,
               std::atomic<uint64_t>& rayCount, const FillOne& fillOne) {
    static_assert(std::is_trivially_copyable_v<Value>);
    parallelRanges(values.size(), kPartTexels, progress, [&](size_t begin, size_t end) {
        const size_t byteCount = (end - begin) * sizeof(Value);
        const uint64_t partKey = hashOf(key, begin);
        if (journal) {
            const std::vector<uint8_t> bytes = journal->load(partKey);
            if (bytes.size() == byteCount) {
                std::memcpy(&values[begin], bytes.data(), byteCount);
                return;
            }
        }
        uint64_t rays = 0;
        for (size_t index = begin; index < end; ++index) {
            progress.throwIfStopped();
            fillOne(index, rays);
        }
        rayCount += rays;
        if (journal) {
            const auto* bytes = reinterpret_cast<const uint8_t*>(&values[begin]);
            journal->store(partKey, {bytes, bytes + byteCount});
        }
    });
}

/// A texel's ray: where it starts and its direction in the world; invalid below the texel's horizon.
struct TexelRay {
    glm::vec3 origin{0};
    glm::vec3 direction{0};
    bool valid = false;
};

TexelRay texelRay(const GatherInput& input, const ChosenDirections& chosen, size_t texel) {
    TexelRay ray;
    if (!input.points.valid(texel) || chosen.pdf[texel] <= 0.0f) return ray;
    const glm::uvec2 xy(texel % input.atlas.sizeTexels.x, texel / input.atlas.sizeTexels.x);
    const Frame& frame = input.frames[input.atlas.blockAt(xy)];
    const bool back = input.atlas.charts[input.atlas.chartAt(xy)].back;

    ray.direction = glm::normalize(frame.toWorld(chosen.directionBlock[texel]));
    const Scene& scene = input.rays.scene();
    const glm::uvec3 t = scene.triangles[input.points.triangle[texel]];
    const glm::vec3 flatNormal =
        (back ? -1.0f : 1.0f) *
        glm::cross(scene.positions[t.y] - scene.positions[t.x], scene.positions[t.z] - scene.positions[t.x]);
    ray.valid = glm::dot(ray.direction, input.points.normal[texel]) > 0.0f &&
                glm::dot(ray.direction, flatNormal) > 0.0f;
    ray.origin = offsetOrigin(input.points.position[texel], glm::normalize(flatNormal));
    return ray;
}

/// Radiance by the photons at the ray's hit: the paper's exact-solution analogue (section 5.1.2).
IncidentRadiance photonIncident(const GatherInput& input, const TexelRay& ray,
                                const DensityEstimate& density) {
    IncidentRadiance incident;
    incident.rays = 1;
    const Hit hit = input.rays.closestHit(ray.origin, ray.direction);
    if (!hit) return incident;
    incident.distance = hit.distance;
    const SurfacePoint point = surfaceAt(input.rays.scene(), hit, ray.direction);
    incident.reflected = photonRadiance(input.photons, input.index, point, -ray.direction, density,
                                        [](const Photon&) { return true; });
    return incident;
}

IncidentRadiance incidentAt(const GatherInput& input, const ChosenDirections& chosen, const TexelRay& ray,
                            size_t texel, int layer, const BakeSettings& settings) {
    if (settings.radiance == RadianceSource::photons) return photonIncident(input, ray, settings.density);
    if (settings.radiance == RadianceSource::path) {
        const PathSettings path{settings.pathsPerPhatexel, settings.maxBounces};
        return traceIncident(input.rays, input.lights, ray.origin, ray.direction, path,
                             Rng(hashOf(settings.seed + 0x9a7, uint64_t(layer), texel)));
    }
    // splat: the photon itself is the sample; the ray only tells how far it came.
    IncidentRadiance incident;
    incident.rays = 1;
    if (const Hit hit = input.rays.closestHit(ray.origin, ray.direction)) incident.distance = hit.distance;
    incident.reflected = chosen.splatRadiance[texel];
    return incident;
}

Phatexel makePhatexel(const ChosenDirections& chosen, size_t texel, glm::vec3 radiance, float distance) {
    return {radiance, chosen.directionBlock[texel], distance, chosen.pdf[texel], true};
}

/// Texels that deserve further rounds, judged by their eight neighbours alone: had a texel's own first samples a
/// say in how many follow, the mean of them all would be biased.
std::vector<uint8_t> hardTexels(const GatherInput& input, const std::vector<IrradianceEstimate>& first) {
    const glm::ivec2 size(input.atlas.sizeTexels);
    std::vector<uint8_t> hard(first.size(), 0);
    for (int y = 0; y < size.y; ++y) {
        for (int x = 0; x < size.x; ++x) {
            bool shadowed = false;
            float light = 0, variance = 0, count = 0;
            for (int i = 0; i < 9; ++i) {
                const glm::ivec2 p = glm::ivec2(x, y) + glm::ivec2(i % 3 - 1, i / 3 - 1);
                if (i == 4 || p.x < 0 || p.y < 0 || p.x >= size.x || p.y >= size.y) continue;
                const size_t neighbor = size_t(p.y) * size.x + p.x;
                if (!input.points.valid(neighbor)) continue;
                shadowed |= first[neighbor].partlyShadowed;
                light += luminance(first[neighbor].value);
                variance += first[neighbor].variance;
                count += 1;
            }
            const bool noisy = variance * count > square(kQuietRelativeError * light);
            hard[size_t(y) * size.x + x] = shadowed || noisy;
        }
    }
    return hard;
}

}  // namespace

PhatexelLayer gatherIndirect(const GatherInput& input, const ChosenDirections& chosen, int layer,
                             const BakeSettings& settings, Progress& progress, BakeJournal* journal,
                             std::atomic<uint64_t>& rayCount) {
    PhatexelLayer result;
    result.texels.resize(input.atlas.texelCount());
    fillParts(result.texels, hashOf(uint64_t(Stage::indirect), uint64_t(layer)), progress, journal, rayCount,
              [&](size_t texel, uint64_t& rays) {
                  const TexelRay ray = texelRay(input, chosen, texel);
                  if (!ray.valid) return;
                  const IncidentRadiance incident = incidentAt(input, chosen, ray, texel, layer, settings);
                  rays += incident.rays;
                  result.texels[texel] =
                      packPhatexel(makePhatexel(chosen, texel, incident.reflected, incident.distance));
              });
    return result;
}

PhatexelLayer gatherArea(const GatherInput& input, const ChosenDirections& chosen, Progress& progress,
                         BakeJournal* journal, std::atomic<uint64_t>& rayCount) {
    PhatexelLayer result;
    result.texels.resize(input.atlas.texelCount());
    fillParts(
        result.texels, uint64_t(Stage::area), progress, journal, rayCount, [&](size_t texel, uint64_t& rays) {
            const TexelRay ray = texelRay(input, chosen, texel);
            if (!ray.valid) return;
            const PathSettings emissionOnly{.pathsPerHit = 0, .maxBounces = 0};
            const IncidentRadiance incident =
                traceIncident(input.rays, input.lights, ray.origin, ray.direction, emissionOnly, Rng(0));
            result.texels[texel] =
                packPhatexel(makePhatexel(chosen, texel, incident.emitted, incident.distance));
            rays += incident.rays;
        });
    return result;
}

std::vector<IrradianceEstimate> gatherAreaIrradiance(const GatherInput& input, const BakeSettings& settings,
                                                     Progress& progress, BakeJournal* journal,
                                                     std::atomic<uint64_t>& rayCount) {
    const int samplesPerRound = std::max(settings.irradianceSamples / kFirstRounds, 1);
    const auto estimate = [&](Stage stage, int rounds, const auto& wanted) {
        std::vector<IrradianceEstimate> estimates(input.atlas.texelCount());
        fillParts(estimates, uint64_t(stage), progress, journal, rayCount, [&](size_t texel, uint64_t& rays) {
            if (!input.points.valid(texel) || !wanted(texel)) return;
            estimates[texel] = areaIrradiance(
                input.rays, input.lights, input.points.position[texel], input.points.normal[texel],
                samplesPerRound, rounds, Rng(hashOf(settings.seed + 0x17, uint64_t(stage), texel)), rays);
        });
        return estimates;
    };
    std::vector<IrradianceEstimate> estimates =
        estimate(Stage::areaIrradiance, kFirstRounds, [](size_t) { return true; });
    const std::vector<uint8_t> hard = hardTexels(input, estimates);
    const std::vector<IrradianceEstimate> further =
        estimate(Stage::moreAreaIrradiance, kFurtherRounds, [&](size_t texel) { return hard[texel] != 0; });

    constexpr float kAll = kFirstRounds + kFurtherRounds;
    constexpr float kFirstShare = kFirstRounds / kAll, kFurtherShare = kFurtherRounds / kAll;
    for (size_t texel = 0; texel < estimates.size(); ++texel) {
        if (!hard[texel]) continue;
        IrradianceEstimate& both = estimates[texel];
        both.value = kFirstShare * both.value + kFurtherShare * further[texel].value;
        both.variance =
            square(kFirstShare) * both.variance + square(kFurtherShare) * further[texel].variance;
    }
    return estimates;
}

}  // namespace phat
