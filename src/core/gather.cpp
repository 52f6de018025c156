#include "core/gather.h"

#include <cstring>

#include "core/parallel.h"

namespace phat {
namespace {

// Texels a part: 16 or 32 kB, so that a record of the journal outweighs its header and the wait for the disk.
constexpr size_t kPartTexels = 2048;

enum class Stage : uint64_t { indirect = 1, area = 2, areaIrradiance = 3 };

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
    std::vector<IrradianceEstimate> estimates(input.atlas.texelCount());
    fillParts(estimates, uint64_t(Stage::areaIrradiance), progress, journal, rayCount,
              [&](size_t texel, uint64_t& rays) {
                  if (!input.points.valid(texel)) return;
                  estimates[texel] = areaIrradiance(input.rays, input.lights, input.points.position[texel],
                                                    input.points.normal[texel], settings.irradianceSamples,
                                                    Rng(hashOf(settings.seed + 0x17, 0, texel)), rays);
              });
    return estimates;
}

}  // namespace phat
