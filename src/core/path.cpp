#include "core/path.h"

#include "core/brdf.h"

namespace phat {
namespace {

// Paths are kept whole for two bounces; roulette on the first ones only adds noise.
constexpr int kFirstRouletteBounce = 2;

glm::vec3 originOn(const SurfacePoint& point, glm::vec3 direction) {
    const float side = glm::dot(direction, point.normalGeometric) >= 0.0f ? 1.0f : -1.0f;
    return offsetOrigin(point.position, side * point.normalGeometric);
}

// A direction that the shading normal allows may still point into the flat triangle: light does not pass.
bool leavesSurface(const SurfacePoint& point, glm::vec3 direction) {
    return glm::dot(direction, point.normalGeometric) > 0.0f;
}

// Whether light from `distance` away arrives; the ray stops just short of the lamp itself.
bool seesLight(const RayScene& rays, glm::vec3 origin, const LightSample& light) {
    constexpr float kShortOfLamp = 1.0f - 1e-4f;
    return !rays.anyHit(origin, light.towardLight, light.distance * kShortOfLamp);
}

glm::vec3 punctualLight(const RayScene& rays, const LightSampler& lights, const SurfacePoint& point,
                        glm::vec3 towardEye, uint64_t& rayCount) {
    glm::vec3 sum(0);
    const size_t count = rays.scene().lights.size();
    for (size_t i = 0; i < count; ++i) {
        const LightSample light = lights.samplePunctual(i, point.position);
        if (light.pdf <= 0.0f || !leavesSurface(point, light.towardLight)) continue;
        const glm::vec3 reflected =
            light.radiance * evaluateBrdf(point.brdf, point.shading.toLocal(towardEye),
                                          point.shading.toLocal(light.towardLight));
        if (maxComponent(reflected) <= 0.0f) continue;
        ++rayCount;
        if (seesLight(rays, originOn(point, light.towardLight), light)) sum += reflected;
    }
    return sum;
}

glm::vec3 areaLight(const RayScene& rays, const LightSampler& lights, const SurfacePoint& point,
                    glm::vec3 towardEye, Rng& rng, uint64_t& rayCount) {
    const float choice = rng.uniform();
    const LightSample light = lights.sampleArea(point.position, choice, rng.uniform2());
    if (light.pdf <= 0.0f || maxComponent(light.radiance) <= 0.0f || !leavesSurface(point, light.towardLight))
        return glm::vec3(0);
    const glm::vec3 eyeLocal = point.shading.toLocal(towardEye);
    const glm::vec3 lightLocal = point.shading.toLocal(light.towardLight);
    const glm::vec3 value = evaluateBrdf(point.brdf, eyeLocal, lightLocal);
    if (maxComponent(value) <= 0.0f) return glm::vec3(0);
    ++rayCount;
    if (!seesLight(rays, originOn(point, light.towardLight), light)) return glm::vec3(0);
    return value * light.radiance / (light.pdf + sampleBrdfPdf(point.brdf, eyeLocal, lightLocal));
}

glm::vec3 shareOfDiffuse(const LobeValues& lobes) {
    return lobes.diffuse / glm::max(lobes.diffuse + lobes.specular, glm::vec3(1e-30f));
}

glm::vec3 emissionToward(const RayScene& rays, const LightSampler& lights, const Hit& hit,
                         glm::vec3 direction) {
    if (!hit) return lights.environmentRadiance(direction);
    return surfaceAt(rays.scene(), hit, direction).emission;
}

float areaPdf(const LightSampler& lights, glm::vec3 from, const Hit& hit, glm::vec3 direction) {
    return hit ? lights.sampleAreaPdf(from, hit, direction) : lights.sampleEnvironmentPdf(direction);
}

/// One estimator round.
struct IrradianceRound {
    glm::vec3 light{0};  // W/m2
    int seen = 0;        // light samples that would have counted
    int visible = 0;     // and were not in shadow
};

IrradianceRound irradianceRound(const RayScene& rays, const LightSampler& lights, glm::vec3 position,
                                const Frame& frame, int lightSamples, int cosineSamples, Rng& rng,
                                uint64_t& rayCount) {
    // Golden-ratio (R2) points with a random shift: stratified for any count (Roberts 2018).
    constexpr glm::vec2 kR2(0.7548776662f, 0.5698402910f);
    IrradianceRound round;
    const glm::vec3 origin = offsetOrigin(position, frame.normal);

    const float choiceShift = rng.uniform();
    const glm::vec2 squareShift = rng.uniform2();
    for (int i = 0; i < lightSamples; ++i) {
        const float choice = (float(i) + choiceShift) / float(lightSamples);
        const LightSample light =
            lights.sampleArea(position, choice, glm::fract(squareShift + float(i) * kR2));
        const float cosine = glm::dot(light.towardLight, frame.normal);
        if (light.pdf <= 0.0f || cosine <= 0.0f) continue;
        // Both strategies' samples share one sum: value / (n_1 p_1 + n_2 p_2).
        const float weight = cosine / (float(lightSamples) * light.pdf + float(cosineSamples) * cosine / kPi);
        if (maxComponent(light.radiance) <= 0.0f) continue;
        ++round.seen;
        ++rayCount;
        if (!seesLight(rays, origin, light)) continue;
        ++round.visible;
        round.light += weight * light.radiance;
    }
    const glm::vec2 cosineShift = rng.uniform2();
    for (int i = 0; i < cosineSamples; ++i) {
        const glm::vec3 local = squareToCosineHemisphere(glm::fract(cosineShift + float(i) * kR2));
        if (local.z <= 0.0f) continue;
        const glm::vec3 direction = frame.toWorld(local);
        ++rayCount;
        const Hit hit = rays.closestHit(origin, direction);
        const float pdf = areaPdf(lights, position, hit, direction);
        if (pdf <= 0.0f) continue;
        const float weight = local.z / (float(lightSamples) * pdf + float(cosineSamples) * local.z / kPi);
        round.light += weight * emissionToward(rays, lights, hit, direction);
    }
    return round;
}

}  // namespace

ReflectedRadiance tracePath(const RayScene& rays, const LightSampler& lights, const SurfacePoint& start,
                            glm::vec3 towardEye, int maxBounces, Rng& rng, uint64_t& rayCount) {
    SurfacePoint point = start;
    ReflectedRadiance reflected;
    glm::vec3 indirect(0), throughput(1), diffuseShare(0);
    for (int bounce = 0; bounce < maxBounces; ++bounce) {
        glm::vec3& radiance = bounce == 0 ? reflected.direct : indirect;
        radiance += throughput * punctualLight(rays, lights, point, towardEye, rayCount);
        if (lights.hasArea())
            radiance += throughput * areaLight(rays, lights, point, towardEye, rng, rayCount);

        const glm::vec3 eyeLocal = point.shading.toLocal(towardEye);
        const float lobe = rng.uniform();
        const BrdfSample sample = sampleBrdf(point.brdf, eyeLocal, lobe, rng.uniform2());
        if (sample.pdf <= 0.0f) break;
        const glm::vec3 direction = glm::normalize(point.shading.toWorld(sample.direction));
        if (!leavesSurface(point, direction)) break;
        if (bounce == 0) diffuseShare = shareOfDiffuse(evaluateLobes(point.brdf, eyeLocal, sample.direction));
        throughput *= sample.weight;
        if (bounce >= kFirstRouletteBounce) {
            // The square root: paths that survive carry little, so the rare ones do not stand out as noise.
            const float survival = std::min(std::sqrt(maxComponent(throughput)), 1.0f);
            if (rng.uniform() >= survival) break;
            throughput /= survival;
        }

        ++rayCount;
        const Hit hit = rays.closestHit(originOn(point, direction), direction);
        const float lightPdf = areaPdf(lights, point.position, hit, direction);
        const float weight = sample.pdf / (sample.pdf + lightPdf);
        if (!hit) {
            radiance += throughput * weight * lights.environmentRadiance(direction);
            break;
        }
        point = surfaceAt(rays.scene(), hit, direction);
        radiance += throughput * weight * point.emission;
        towardEye = -direction;
    }
    reflected.indirectDiffuse = diffuseShare * indirect;
    reflected.indirectGlossy = indirect - reflected.indirectDiffuse;
    return reflected;
}

glm::vec3 traceReflected(const RayScene& rays, const LightSampler& lights, const SurfacePoint& point,
                         glm::vec3 towardEye, int maxBounces, Rng& rng, uint64_t& rayCount) {
    return tracePath(rays, lights, point, towardEye, maxBounces, rng, rayCount).sum();
}

IncidentRadiance traceIncident(const RayScene& rays, const LightSampler& lights, glm::vec3 origin,
                               glm::vec3 direction, const PathSettings& settings, Rng rng) {
    IncidentRadiance incident;
    incident.rays = 1;
    const Hit hit = rays.closestHit(origin, direction);
    if (!hit) {
        incident.emitted = lights.environmentRadiance(direction);
        return incident;
    }
    incident.distance = hit.distance;
    const SurfacePoint point = surfaceAt(rays.scene(), hit, direction);
    incident.emitted = point.emission;
    if (maxComponent(point.brdf.diffuseColor + point.brdf.f0 + point.brdf.f90 + point.brdf.clearcoat) <= 0.0f)
        return incident;
    for (int i = 0; i < settings.pathsPerHit; ++i)
        incident.reflected +=
            traceReflected(rays, lights, point, -direction, settings.maxBounces, rng, incident.rays);
    incident.reflected /= float(std::max(settings.pathsPerHit, 1));
    return incident;
}

IrradianceEstimate areaIrradiance(const RayScene& rays, const LightSampler& lights, glm::vec3 position,
                                  glm::vec3 normal, int lightSamplesPerRound, int rounds, Rng rng,
                                  uint64_t& rayCount) {
    const Frame frame = frameFromNormal(normal);
    const int cosineSamples = std::max(lightSamplesPerRound / 2, 1);
    glm::vec3 sum(0);
    double luminances = 0, squares = 0;
    int seen = 0, visible = 0;
    for (int i = 0; i < rounds; ++i) {
        const IrradianceRound round = irradianceRound(rays, lights, position, frame, lightSamplesPerRound,
                                                      cosineSamples, rng, rayCount);
        const double value = luminance(round.light);
        sum += round.light;
        luminances += value;
        squares += value * value;
        seen += round.seen;
        visible += round.visible;
    }
    const double spread = std::max(squares - luminances * luminances / rounds, 0.0);
    return {sum / float(rounds), float(spread / (double(rounds) * (rounds - 1))),
            visible > 0 && visible < seen};
}

}  // namespace phat
