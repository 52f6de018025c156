#include "core/render/lobe_rays.h"

#include <cassert>

#include "core/base/sobol.h"
#include "core/transport/path_vertex.h"

namespace phat {
namespace {

// The greatest length of the walks that go on from glossy hits.
constexpr int kMaxBounces = 8;

// Power heuristic (Veach 1997): with the balance heuristic, the rare light samples that fall into a sharp
// lobe would count in full, although its BRDF samples find the same light reliably. pre: own > 0.
float powerWeight(float own, float other) {
    assert(own > 0.0f);
    return 1.0f / (1.0f + square(other / own));
}

// Whether light samples leave a direction to the lobe's rays.
bool isDimSky(const ReflectionScene& scene, glm::vec3 radiance) {
    return luminance(radiance) < scene.minSampledSky;
}

}  // namespace

glm::vec2 RayNumbers::of(int ray) const {
    return glm::vec2(sobol4(first + uint32_t(ray) * stride, seed));
}

// What a ray met, with its textures filtered over what the pixel shows of it: where the rays of the next
// pixels would meet its plane, were they parallel to this one but for the steps.
SurfacePoint LobeRays::surfaceOf(const SeenThrough& seen) const {
    const Scene& of = scene.rays.scene();
    const glm::vec3 direction = seen.ray.direction;
    if (scene.levels.empty()) return surfaceAt(of, seen.hit, direction);
    const glm::uvec3 t = of.triangles[seen.hit.triangle];
    const glm::vec3 across =
        glm::cross(of.positions[t.y] - of.positions[t.x], of.positions[t.z] - of.positions[t.x]);
    const float cosine = glm::dot(across, direction);
    if (cosine == 0.0f) return surfaceAt(of, seen.hit, direction);
    Footprint footprint{scene.levels, {}};
    for (int i = 0; i < 2; ++i) {
        const glm::vec3 step = steps.position[i] + seen.hit.distance * steps.mirror[i];
        footprint.sides[i] = step - glm::dot(across, step) / cosine * direction;
    }
    return surfaceAt(of, seen.hit, direction, footprint);
}

// One light sample over the lobe's albedo: small emitters that BRDF samples rarely hit.
glm::vec3 LobeRays::estimateByLightSample(Rng& rng) const {
    const float choice = rng.uniform();
    const LightSample light = scene.lights.sampleArea(point.position, choice, rng.uniform2());
    if (light.pdf <= 0.0f || maxComponent(light.radiance) <= 0.0f || !leavesSurface(point, light.towardLight))
        return glm::vec3(0);
    if (light.triangle == kNoTriangle && isDimSky(scene, light.radiance)) return glm::vec3(0);
    const glm::vec3 local = point.shading.toLocal(light.towardLight);
    const float value = evaluateBrdf(point.brdf, eyeLocal, local).x;
    if (value <= 0.0f) return glm::vec3(0);
    const float weight = powerWeight(light.pdf, sampleBrdfPdf(point.brdf, eyeLocal, local));
    // Below this weight no emitter is bright enough to be visible, and the shadow ray is saved.
    constexpr float kMinWeight = 1e-6f;
    if (weight < kMinWeight) return glm::vec3(0);
    const glm::vec3 transmittance = transmittanceToLight(
        scene.rays, point.position, originOn(scene.rays, point, light.towardLight), light, rayCount);
    return transmittance * (value * weight / light.pdf / albedo * light.radiance);
}

TracedLight LobeRays::trace(int count, int walks, const RayNumbers& numbers, uint64_t stream) const {
    const TexelWorld world{{scene.rays, scene.lights}, scene.atlas, scene.points, scene.texels};
    const TexelIrradiance irradiance{scene.phatexture.indirectIrradiance, scene.phatexture.areaIrradiance,
                                     true};
    const PathSettings further{walks, kMaxBounces};
    PooledLight incident;
    HitGlossSum gloss;
    glm::vec3 sampled(0);
    const bool isMirror = point.brdf.alpha < kMinPooledAlpha;
    for (int i = 0; i < count; ++i) {
        Rng rng(hashOf(stream, view.frame, uint64_t(i)));
        if (view.area && scene.lights.hasArea() && !isMirror) sampled += estimateByLightSample(rng);
        glm::vec2 square = numbers.of(i);
        if (isMirror) square.x *= kMirrorPart;
        const BrdfSample sample = sampleBrdf(point.brdf, eyeLocal, 0.5f, square);
        if (sample.pdf <= 0.0f) continue;
        const glm::vec3 direction = glm::normalize(point.shading.toWorld(sample.direction));
        if (!leavesSurface(point, direction)) continue;
        const float weight = sample.weight.x;
        incident.weight += weight;

        ++rayCount;
        const SeenThrough seen =
            seeThrough(scene.rays, {originOn(scene.rays, point, direction), direction}, stream, rayCount);
        const glm::vec3 arriving = seen.ray.direction;
        const glm::vec3 sky = seen.hit ? glm::vec3(0) : scene.lights.environmentRadiance(arriving);
        const bool ownAlone = isMirror || (!seen.hit && isDimSky(scene, sky));
        const float lightPdf = ownAlone ? 0.0f : areaPdf(scene.lights, point.position, seen.hit, arriving);
        const glm::vec3 emissionWeight = weight * powerWeight(sample.pdf, lightPdf) * seen.throughput;
        if (!seen.hit) {
            incident.area += emissionWeight * sky;
            continue;
        }
        const SurfacePoint far = surfaceOf(seen);
        incident.area += emissionWeight * far.emission;
        if (!view.indirect) continue;
        const HitReflection reflected =
            reflectedFromTexels(world, irradiance, {seen.hit, far, -arriving}, further, rng, rayCount);
        incident.indirect += weight * seen.throughput * reflected.rest;
        const GlossyHit glossy{sideOf(scene.rays.scene(), seen.hit), arriving, far, reflected};
        if (!gloss.add(glossy, weight * seen.throughput))
            incident.indirect += weight * seen.throughput * reflected.glossy;
    }
    if (incident.weight <= 0.0f) return {};
    incident.indirect /= incident.weight;
    incident.area = incident.area / incident.weight + sampled / float(count);
    // A clamp: the two are independent estimates, whose noise must not exceed all light that there is.
    HitGloss atHits = gloss.mean(incident.weight);
    const glm::vec3 sum = incident.indirect + incident.area + atHits.carried * atHits.light.indirect;
    const glm::vec3 scale = glm::min(glm::vec3(1), scene.brightest / glm::max(sum, glm::vec3(1e-20f)));
    incident.indirect *= scale;
    incident.area *= scale;
    atHits.carried *= scale;
    return {incident, atHits};
}

}  // namespace phat
