#include "core/bake/gather.h"

#include <optional>

#include "core/bake/gather_parts.h"
#include "core/bake/irradiance_ray.h"
#include "core/scene/glass.h"
#include "core/transport/area_irradiance.h"

namespace phat {
namespace {

// For nearer hits the lookup reads fewer PHATexels, so that the noise of each matters: measured,
// notes/experiments.md.
constexpr float kNearTexels = 160.0f;

// Rounds of light samples for every texel, and further ones for those in penumbrae or noise.
constexpr int kFirstRounds = 2, kFurtherRounds = 6;
// Relative standard errors below this need no further rounds: the filter removes them.
constexpr float kQuietRelativeError = 0.02f;

/// A texel's ray; nothing below the texel's horizon.
std::optional<Ray> texelRay(const GatherInput& input, const TexelDirection& chosen, size_t texel) {
    if (!input.points.valid(texel) || chosen.pdf <= 0.0f) return {};
    const glm::uvec2 xy(texel % input.atlas.sizeTexels.x, texel / input.atlas.sizeTexels.x);
    const Frame& frame = input.frames[input.atlas.blockAt(xy)];

    const glm::vec3 direction = glm::normalize(frame.toWorld(chosen.directionBlock));
    const glm::vec3 flatNormal = flatNormalOf(input.rays.scene(), input.atlas, input.points, texel);
    if (glm::dot(direction, input.points.normal[texel]) <= 0.0f || glm::dot(direction, flatNormal) <= 0.0f)
        return {};
    return Ray{input.rays.offsetOrigin(input.points.position[texel], flatNormal), direction};
}

/// Radiance by the photons at the ray's hit: the paper's exact-solution analogue (section 5.1.2).
IncidentRadiance photonIncident(const GatherInput& input, const Ray& ray, const DensityEstimate& density) {
    IncidentRadiance incident;
    incident.rays = 1;
    const SeenThrough seen = seeThrough(input.rays, ray, 0, incident.rays);
    if (!seen.hit) return incident;
    incident.distance = seen.hit.distance;
    const SurfacePoint point = surfaceAt(input.rays.scene(), seen.hit, seen.ray.direction);
    incident.reflected =
        seen.throughput * photonRadiance({input.photons, input.index}, point, -seen.ray.direction, density,
                                         [](const Photon&) { return true; });
    return incident;
}

IncidentRadiance incidentAt(const IndirectLayer& of, const TexelDirection& chosen, const Ray& ray,
                            size_t texel) {
    const GatherInput& input = of.input;
    const BakeSettings& settings = of.settings;
    const PathSettings path{settings.pathsPerPhatexel, settings.maxBounces};
    const Rng rng(hashOf(settings.seed + 0x9a7, uint64_t(of.layer), texel));
    switch (settings.radiance) {
        case RadianceSource::texels:
            return incidentFromTexels(input, of.irradiance, ray, path,
                                      kNearTexels * input.atlas.texelMetersAt(texel), rng);
        case RadianceSource::path:
            return traceIncident(input.scene(), ray, path, rng);
        case RadianceSource::photons:
            return photonIncident(input, ray, settings.density);
        case RadianceSource::splat:
            break;
    }
    // splat: the photon itself is the sample; the ray gives only its distance.
    IncidentRadiance incident;
    incident.rays = 1;
    if (const Hit hit = input.rays.closestHit(ray.origin, ray.direction)) incident.distance = hit.distance;
    incident.reflected = chosen.splatRadiance;
    return incident;
}

PackedPhatexel packed(const GatherInput& input, const TexelDirection& chosen, glm::vec3 radiance,
                      float distance) {
    return packPhatexel({radiance, chosen.directionBlock, distance, chosen.pdf, true},
                        input.atlas.unitMeters);
}

/// The further rounds that a texel deserves.
enum class Further : uint8_t { none, sparse, all };

/// Judged by a texel's eight neighbours alone: had its own first samples a say in how many follow, the mean
/// of them all would be biased. Where all that they sampled is seen, what is left is the noise of the lights'
/// samples, for which few shadow rays do.
template <typename FirstEstimate>
Further furtherRounds(const GatherInput& input, glm::ivec2 texel, const FirstEstimate& first) {
    const glm::ivec2 size(input.atlas.sizeTexels);
    bool shadowed = false, dark = input.rays.hasGlass();  // whose shadows are neither
    float light = 0, variance = 0, count = 0;
    for (int i = 0; i < 9; ++i) {
        const glm::ivec2 p = texel + glm::ivec2(i % 3 - 1, i / 3 - 1);
        if (i == 4 || p.x < 0 || p.y < 0 || p.x >= size.x || p.y >= size.y) continue;
        const size_t neighbor = size_t(p.y) * size.x + p.x;
        if (!input.irradianceTexels[neighbor]) continue;
        const IrradianceEstimate& estimate = first(neighbor);
        shadowed |= estimate.partlyShadowed;
        dark |= maxComponent(estimate.value) <= 0.0f;
        light += luminance(estimate.value);
        variance += estimate.variance;
        count += 1;
    }
    if (shadowed) return Further::all;
    const bool noisy = variance * count > square(kQuietRelativeError * light);
    if (!noisy) return Further::none;
    return dark ? Further::all : Further::sparse;
}

/// The rounds of a texel.
class AreaRounds {
  public:
    AreaRounds(const GatherInput& input, const BakeSettings& settings)
        : input_(input), settings_(settings), sampler_(input.scene()) {}

    IrradianceEstimate first(size_t texel, uint64_t& rays) const {
        return rounds(GatherStage::areaIrradiance, texel, ShadowRays::all, rays);
    }
    /// pre: further != Further::none.
    IrradianceEstimate more(size_t texel, Further further, uint64_t& rays) const {
        return rounds(GatherStage::moreAreaIrradiance, texel,
                      further == Further::sparse ? ShadowRays::sparse : ShadowRays::all, rays);
    }

  private:
    IrradianceEstimate rounds(GatherStage stage, size_t texel, ShadowRays shadowRays, uint64_t& rays) const {
        const IrradianceSampling sampling{
            std::max(settings_.irradianceSamples / kFirstRounds, 1),
            stage == GatherStage::areaIrradiance ? kFirstRounds : kFurtherRounds};
        return sampler_.areaIrradiance(input_.points.position[texel], input_.points.normal[texel], sampling,
                                       shadowRays, Rng(hashOf(settings_.seed + 0x17, uint64_t(stage), texel)),
                                       rays);
    }

    const GatherInput& input_;
    const BakeSettings& settings_;
    AreaIrradianceSampler sampler_;
};

IrradianceEstimate joined(const IrradianceEstimate& first, const IrradianceEstimate& further) {
    constexpr float kAll = kFirstRounds + kFurtherRounds;
    constexpr float kFirstFraction = kFirstRounds / kAll, kFurtherFraction = kFurtherRounds / kAll;
    // Of sparse rounds, the occluded samples may take away more than the others brought.
    return {glm::max(kFirstFraction * first.value + kFurtherFraction * further.value, 0.0f),
            square(kFirstFraction) * first.variance + square(kFurtherFraction) * further.variance,
            first.partlyShadowed};
}

}  // namespace

PackedPhatexel indirectPhatexel(const IndirectLayer& layer, const TexelDirection& direction, size_t texel,
                                uint64_t& rays) {
    const std::optional<Ray> ray = texelRay(layer.input, direction, texel);
    if (!ray) return {};
    const IncidentRadiance incident = incidentAt(layer, direction, *ray, texel);
    rays += incident.rays;
    return packed(layer.input, direction, incident.reflected, incident.distance);
}

PackedPhatexel areaPhatexel(const GatherInput& input, const TexelDirection& direction, size_t texel,
                            uint64_t& rays) {
    const std::optional<Ray> ray = texelRay(input, direction, texel);
    if (!ray) return {};
    const PathSettings emissionOnly{.pathsPerHit = 0, .maxBounces = 0};
    const IncidentRadiance incident = traceIncident(input.scene(), *ray, emissionOnly, Rng(0));
    rays += incident.rays;
    return packed(input, direction, incident.emitted, incident.distance);
}

PhatexelLayer gatherIndirect(const GatherContext& context, const ChosenDirections& chosen,
                             const TexelIrradiance& irradiance, int layer) {
    const IndirectLayer of{context.input, irradiance, context.settings, layer};
    PhatexelLayer result;
    result.texels.resize(context.input.atlas.texelCount());
    fillParts(result.texels, hashOf(uint64_t(GatherStage::indirect), uint64_t(layer)), context,
              [&](size_t texel, uint64_t& rays) {
                  result.texels[texel] = indirectPhatexel(of, chosen.at(texel), texel, rays);
              });
    return result;
}

PhatexelLayer gatherArea(const GatherContext& context, const ChosenDirections& chosen) {
    PhatexelLayer result;
    result.texels.resize(context.input.atlas.texelCount());
    fillParts(result.texels, uint64_t(GatherStage::area), context, [&](size_t texel, uint64_t& rays) {
        result.texels[texel] = areaPhatexel(context.input, chosen.at(texel), texel, rays);
    });
    return result;
}

std::vector<IrradianceEstimate> gatherAreaIrradiance(const GatherContext& context) {
    const GatherInput& input = context.input;
    const AreaRounds rounds(input, context.settings);
    const size_t count = input.atlas.texelCount(), width = input.atlas.sizeTexels.x;
    std::vector<IrradianceEstimate> estimates(count);
    fillParts(estimates, uint64_t(GatherStage::areaIrradiance), context, [&](size_t texel, uint64_t& rays) {
        if (input.irradianceTexels[texel]) estimates[texel] = rounds.first(texel, rays);
    });
    std::vector<Further> further(count);
    for (size_t texel = 0; texel < count; ++texel)
        further[texel] = furtherRounds(input, {texel % width, texel / width},
                                       [&](size_t i) -> const IrradianceEstimate& { return estimates[i]; });
    std::vector<IrradianceEstimate> more(count);
    fillParts(more, uint64_t(GatherStage::moreAreaIrradiance), context, [&](size_t texel, uint64_t& rays) {
        if (input.irradianceTexels[texel] && further[texel] != Further::none)
            more[texel] = rounds.more(texel, further[texel], rays);
    });
    for (size_t texel = 0; texel < count; ++texel)
        if (further[texel] != Further::none) estimates[texel] = joined(estimates[texel], more[texel]);
    return estimates;
}

void updateAreaIrradiance(const GatherInput& input, const BakeSettings& settings, glm::uvec2 corner,
                          glm::uvec2 size, std::vector<IrradianceEstimate>& estimates, uint64_t& rays) {
    // With a ring around, whose first rounds decide which texels at the border get further ones.
    const AreaRounds rounds(input, settings);
    const glm::ivec2 low = glm::max(glm::ivec2(corner) - 1, glm::ivec2(0));
    const glm::ivec2 high = glm::min(glm::ivec2(corner + size) + 1, glm::ivec2(input.atlas.sizeTexels));
    const int width = high.x - low.x, atlasWidth = int(input.atlas.sizeTexels.x);
    std::vector<IrradianceEstimate> first(size_t(width) * (high.y - low.y));
    const auto firstAt = [&](size_t texel) -> IrradianceEstimate& {
        const glm::ivec2 p(int(texel) % atlasWidth, int(texel) / atlasWidth);
        return first[size_t(p.y - low.y) * width + (p.x - low.x)];
    };
    for (int y = low.y; y < high.y; ++y)
        for (int x = low.x; x < high.x; ++x) {
            const size_t texel = size_t(y) * atlasWidth + x;
            if (input.irradianceTexels[texel]) firstAt(texel) = rounds.first(texel, rays);
        }
    for (uint32_t y = corner.y; y < corner.y + size.y; ++y)
        for (uint32_t x = corner.x; x < corner.x + size.x; ++x) {
            const size_t texel = size_t(y) * atlasWidth + x;
            estimates[texel] = firstAt(texel);
            if (!input.irradianceTexels[texel]) continue;
            const Further further = furtherRounds(input, {x, y}, firstAt);
            if (further != Further::none)
                estimates[texel] = joined(estimates[texel], rounds.more(texel, further, rays));
        }
}

}  // namespace phat
