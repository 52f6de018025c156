#include "core/transport/path.h"

#include <cassert>

#include "core/scene/brdf.h"
#include "core/scene/glass.h"
#include "core/transport/path_vertex.h"

namespace phat {
namespace {

// No roulette for the first two bounces, where it only adds noise.
constexpr int kFirstRouletteBounce = 2;
// Survival is this times the root of the throughput. Of 1, 2, 3 and 5, 2 took the fewest rays to a relMSE of
// .01 on the Cornell box and the tabletop: 0.84 and 0.69 times those of 1, whose survivors are fireflies
// where a metal reflects a light.
constexpr float kRouletteScale = 2.0f;

// Of the Lambert lobe's samples.
// Of .3, .5, .7 and .85, the last had the least relMSE on tabletop.
constexpr float kGuidedFraction = 0.85f;

// Up to this number of punctual lights, each has a shadow ray at every bounce; of more, one is sampled. ours,
// untuned: the rays of a bounce then cost a few times the path's own.
constexpr size_t kMaxLightsEach = 4;

}  // namespace

glm::vec3 originOn(const RayScene& rays, const SurfacePoint& point, glm::vec3 direction) {
    const float side = glm::dot(direction, point.normalGeometric) >= 0.0f ? 1.0f : -1.0f;
    return rays.offsetOrigin(point.position, side * point.normalGeometric);
}

glm::vec3 transmittanceToLight(const RayScene& rays, glm::vec3 position, glm::vec3 origin,
                               const LightSample& light, uint64_t& rayCount) {
    ++rayCount;
    // Points of light may lie on the surface of their bulb.
    constexpr float kShortOfLight = 1.0f - 1e-4f;
    const auto passes = [](bool visible) { return glm::vec3(visible ? 1.0f : 0.0f); };
    if (light.triangle == kNoTriangle) {
        const float distance = light.distance * kShortOfLight;
        if (!rays.hasGlass()) return passes(!rays.anyHit(origin, light.towardLight, distance));
        const StraightView view = seeStraight(rays, {origin, light.towardLight}, distance, rayCount);
        return view.hit ? glm::vec3(0) : view.transmittance;
    }
    // Toward the very point: a parallel ray from the origin off the surface would pass a rim by that offset.
    const glm::vec3 toward = position + light.distance * light.towardLight - origin;
    const float distance = glm::length(toward);
    // Another triangle in the emitter's plane is met as early as the emitter, but for rounding.
    constexpr float kRounding = 2e-6f;
    const float farthest = distance * (1.0f + kRounding);
    StraightView view;
    if (rays.hasGlass())
        view = seeStraight(rays, {origin, toward / distance}, farthest, rayCount);
    else
        view.hit = rays.closestHit(origin, toward / distance, farthest);
    const Hit& hit = view.hit;
    return view.transmittance *
           passes(!hit || hit.triangle == light.triangle || hit.distance >= distance * (1.0f - kRounding));
}

bool leavesSurface(const SurfacePoint& point, glm::vec3 direction) {
    return glm::dot(direction, point.normalGeometric) > 0.0f;
}

namespace {

// Light of one punctual light as the surface would reflect it, were there no shadow.
struct UnshadowedLight {
    LightSample light;
    glm::vec3 reflected{0};
};

UnshadowedLight unshadowed(const LightSampler& lights, size_t index, const PathVertex& vertex,
                           glm::vec2 square) {
    const SurfacePoint& point = vertex.point;
    UnshadowedLight found{lights.samplePunctual(index, point.position, square), glm::vec3(0)};
    if (found.light.pdf > 0.0f && leavesSurface(point, found.light.towardLight))
        found.reflected =
            found.light.radiance * evaluateBrdf(vertex.brdf, point.shading.toLocal(found.light.towardLight));
    return found;
}

glm::vec3 shadowed(const RayScene& rays, const SurfacePoint& point, const UnshadowedLight& candidate,
                   uint64_t& rayCount) {
    if (maxComponent(candidate.reflected) <= 0.0f) return glm::vec3(0);
    const glm::vec3 origin = originOn(rays, point, candidate.light.towardLight);
    return transmittanceToLight(rays, point.position, origin, candidate.light, rayCount) *
           candidate.reflected;
}

// One of the lights in proportion to its unshadowed contribution, by a weighted reservoir. One number
// decides for all lights: rescaled after each decision, it is uniform again.
glm::vec3 oneOfManyLights(const LitScene& scene, const PathVertex& vertex, glm::vec3 numbers,
                          uint64_t& rayCount) {
    UnshadowedLight chosen;
    double sum = 0, chosenWeight = 0, left = double(numbers.x);
    for (size_t i = 0; i < scene.rays.scene().lights.size(); ++i) {
        const UnshadowedLight candidate = unshadowed(scene.lights, i, vertex, {numbers.y, numbers.z});
        const double weight = double(maxComponent(candidate.reflected));
        if (!(weight > 0)) continue;
        sum += weight;
        const double chance = weight / sum;
        if (left >= chance) {
            left = (left - chance) / (1 - chance);
            continue;
        }
        left /= chance;
        chosen = candidate;
        chosenWeight = weight;
    }
    return chosenWeight > 0 ? shadowed(scene.rays, vertex.point, chosen, rayCount) * float(sum / chosenWeight)
                            : glm::vec3(0);
}

}  // namespace

glm::vec3 punctualLight(const LitScene& scene, const PathVertex& vertex, glm::vec3 numbers,
                        uint64_t& rayCount) {
    const size_t count = scene.rays.scene().lights.size();
    if (count > kMaxLightsEach) return oneOfManyLights(scene, vertex, numbers, rayCount);
    glm::vec3 sum(0);
    for (size_t i = 0; i < count; ++i) {
        const UnshadowedLight candidate = unshadowed(scene.lights, i, vertex, {numbers.y, numbers.z});
        sum += shadowed(scene.rays, vertex.point, candidate, rayCount);
    }
    return sum;
}

glm::vec3 areaLight(const LitScene& scene, const PathVertex& vertex, glm::vec3 numbers, uint64_t& rayCount) {
    const SurfacePoint& point = vertex.point;
    const LightSample light = scene.lights.sampleArea(point.position, numbers.x, {numbers.y, numbers.z});
    if (light.pdf <= 0.0f || maxComponent(light.radiance) <= 0.0f || !leavesSurface(point, light.towardLight))
        return glm::vec3(0);
    const glm::vec3 lightLocal = point.shading.toLocal(light.towardLight);
    const glm::vec3 value = evaluateBrdf(vertex.brdf, lightLocal);
    if (maxComponent(value) <= 0.0f) return glm::vec3(0);
    const glm::vec3 transmittance = transmittanceToLight(
        scene.rays, point.position, originOn(scene.rays, point, light.towardLight), light, rayCount);
    if (maxComponent(transmittance) <= 0.0f) return glm::vec3(0);
    return transmittance * value * light.radiance / (light.pdf + sampleDirectionPdf(vertex, lightLocal));
}

BrdfSample sampleDirection(const PathVertex& vertex, float lobe, glm::vec2 square) {
    if (!vertex.guide) return sampleBrdf(vertex.brdf, lobe, square);
    BrdfSample sample;
    if (lobe < kGuidedFraction * vertex.brdf.chances.x)
        sample.direction = vertex.point.shading.toLocal(sampleGuide(*vertex.guide, square));
    else
        sample = sampleBrdf(vertex.brdf, lobe, square);
    if (sample.direction.z <= 0.0f) return {};
    sample.pdf = sampleDirectionPdf(vertex, sample.direction);
    if (sample.pdf <= 0.0f) return {};
    sample.weight = evaluateBrdf(vertex.brdf, sample.direction) / sample.pdf;
    return sample;
}

float sampleDirectionPdf(const PathVertex& vertex, glm::vec3 local) {
    const float pdf = sampleBrdfPdf(vertex.brdf, local);
    if (!vertex.guide || local.z <= 0.0f) return pdf;
    return pdf + kGuidedFraction * vertex.brdf.chances.x *
                     (sampleGuidePdf(*vertex.guide, vertex.point.shading.toWorld(local)) -
                      squareToCosineHemispherePdf(local));
}

float areaPdf(const LightSampler& lights, glm::vec3 from, const Hit& hit, glm::vec3 direction) {
    return hit ? lights.sampleAreaPdf(from, hit, direction) : lights.sampleEnvironmentPdf(direction);
}

float survivalChance(int bounce, glm::vec3 throughput) {
    if (bounce < kFirstRouletteBounce) return 1.0f;
    // The square root: paths that survive carry little, so the rare ones do not stand out as noise.
    return std::min(kRouletteScale * std::sqrt(maxComponent(throughput)), 1.0f);
}

namespace {

glm::vec3 diffuseFractionOf(const LobeValues& lobes) {
    return lobes.diffuse / glm::max(lobes.diffuse + lobes.specular, glm::vec3(1e-30f));
}

}  // namespace

ReflectedRadiance tracePath(const LitScene& scene, const PathStart& start, int maxBounces,
                            PathNumbers& numbers, uint64_t& rayCount) {
    SurfacePoint point = start.point;
    glm::vec3 towardEye = start.towardEye;
    ReflectedRadiance reflected;
    glm::vec3 indirect(0), throughput(1), diffuseFraction(0);
    for (int bounce = 0; bounce < maxBounces; ++bounce) {
        const glm::vec4 lightNumbers = numbers.next4(), brdfNumbers = numbers.next4();
        PathVertex vertex(point, towardEye);
        if (bounce == 0 && start.first.lobes != Lobes::all)
            vertex.brdf = only(start.first.lobes, vertex.brdf);
        if (!reflects(vertex.brdf)) break;
        if (start.guide && vertex.brdf.chances.x > 0.0f)
            vertex.guide = start.guide->at(point.position, point.normalGeometric);
        glm::vec3& radiance = bounce == 0 ? reflected.direct : indirect;
        if (bounce > 0 || start.first.direct) {
            // A sun shares the point's numbers with the area lights: the two are added, not multiplied.
            const glm::vec3 punctual(lightNumbers.w, lightNumbers.y, lightNumbers.z);
            radiance += throughput * punctualLight(scene, vertex, punctual, rayCount);
            if (scene.lights.hasArea())
                radiance += throughput * areaLight(scene, vertex, glm::vec3(lightNumbers), rayCount);
        }

        const BrdfSample sample = sampleDirection(vertex, brdfNumbers.x, {brdfNumbers.y, brdfNumbers.z});
        if (sample.pdf <= 0.0f) break;
        const glm::vec3 direction = glm::normalize(point.shading.toWorld(sample.direction));
        if (!leavesSurface(point, direction)) break;
        if (bounce == 0) diffuseFraction = diffuseFractionOf(evaluateLobes(vertex.brdf, sample.direction));
        throughput *= sample.weight;
        const float survival = survivalChance(bounce, throughput);
        if (brdfNumbers.w >= survival) break;
        throughput /= survival;

        ++rayCount;
        const SeenThrough seen =
            seeThrough(scene.rays, {originOn(scene.rays, point, direction), direction}, 0, rayCount);
        const glm::vec3 arriving = seen.ray.direction;
        // Light samples go straight through glass: a ray that was bent counts as if it had not been.
        const float lightPdf = areaPdf(scene.lights, point.position, seen.hit, arriving);
        const float weight = sample.pdf / (sample.pdf + lightPdf);
        throughput *= seen.throughput;
        if (!seen.hit) {
            radiance += throughput * weight * scene.lights.environmentRadiance(arriving);
            break;
        }
        point = surfaceAt(scene.rays.scene(), seen.hit, arriving);
        radiance += throughput * weight * point.emission;
        towardEye = -arriving;
    }
    reflected.indirectDiffuse = diffuseFraction * indirect;
    reflected.indirectGlossy = indirect - reflected.indirectDiffuse;
    return reflected;
}

glm::vec3 traceReflected(const LitScene& scene, const PathStart& start, int maxBounces, Rng& rng,
                         uint64_t& rayCount) {
    PathNumbers numbers{Rng(rng.bits64())};
    return tracePath(scene, start, maxBounces, numbers, rayCount).sum();
}

IncidentRadiance traceIncident(const LitScene& scene, const Ray& ray, const PathSettings& settings, Rng rng) {
    IncidentRadiance incident;
    incident.rays = 1;
    const SeenThrough seen = seeThrough(scene.rays, ray, 0, incident.rays);
    const glm::vec3 direction = seen.ray.direction;
    if (!seen.hit) {
        incident.emitted = seen.throughput * scene.lights.environmentRadiance(direction);
        return incident;
    }
    incident.distance = seen.hit.distance;
    const SurfacePoint point = surfaceAt(scene.rays.scene(), seen.hit, direction);
    incident.emitted = seen.throughput * point.emission;
    if (maxComponent(point.brdf.diffuseColor + point.brdf.f0 + point.brdf.f90 + point.brdf.clearcoat) <= 0.0f)
        return incident;
    const uint64_t seed = rng.bits64();
    for (int i = 0; i < settings.pathsPerHit; ++i) {
        PathNumbers numbers(seed, uint32_t(i) % kMaxShuffled);
        incident.reflected +=
            tracePath(scene, {point, -direction}, settings.maxBounces, numbers, incident.rays).sum();
    }
    incident.reflected *= seen.throughput / float(std::max(settings.pathsPerHit, 1));
    return incident;
}

}  // namespace phat
