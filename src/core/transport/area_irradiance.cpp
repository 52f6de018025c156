#include "core/transport/area_irradiance.h"

#include <cassert>

#include "core/scene/glass.h"
#include "core/transport/path_vertex.h"

namespace phat {
namespace {

// More boxes than this would cost more than the rays that they save: one holds all.
constexpr size_t kMaxBoxes = 8;
// By which the boxes are larger, of their coordinates and of the scene's unit: far above the rounding of
// hits.
constexpr float kBoxMargin = 1e-4f;

// Golden-ratio (R2) points with a random shift: stratified for any count (Roberts 2018).
constexpr glm::vec2 kR2(0.7548776662f, 0.5698402910f);

Bounds surfaceBounds(const Scene& scene, const Surface& surface) {
    Bounds bounds;
    for (uint32_t i = 0; i < surface.triangleCount; ++i) {
        const glm::uvec3& corner = scene.triangles[surface.firstTriangle + i];
        for (int c = 0; c < 3; ++c) bounds.add(scene.positions[corner[c]]);
    }
    return bounds;
}

bool meets(const Bounds& box, const Ray& ray) {
    // A zero would make infinities, whose products with zero are no numbers.
    constexpr float kMinComponent = 1e-12f;
    float enter = 0, leave = 1e30f;
    for (int axis = 0; axis < 3; ++axis) {
        const float along = ray.direction[axis];
        const float inverse =
            1.0f / (std::abs(along) < kMinComponent ? std::copysign(kMinComponent, along) : along);
        const float a = (box.low[axis] - ray.origin[axis]) * inverse;
        const float b = (box.high[axis] - ray.origin[axis]) * inverse;
        enter = std::max(enter, std::min(a, b));
        leave = std::min(leave, std::max(a, b));
    }
    return enter <= leave;
}

glm::vec3 emissionToward(const LitScene& scene, const Hit& hit, glm::vec3 direction) {
    if (!hit) return scene.lights.environmentRadiance(direction);
    return surfaceAt(scene.rays.scene(), hit, direction).emission;
}

}  // namespace

// Glass offsets rays at each crossing, and so they are straight only nearly.
ShiningBounds::ShiningBounds(const RayScene& rays) : anywhere_(rays.hasGlass()) {
    const Scene& scene = rays.scene();
    Bounds all;
    for (const Surface& surface : scene.surfaces) {
        if (!(maxComponent(scene.materials[surface.material].emission) > 0)) continue;
        Bounds box = surfaceBounds(scene, surface);
        if (box.empty()) continue;
        const float largest = std::max(maxComponent(glm::abs(box.low)), maxComponent(glm::abs(box.high)));
        const float margin = kBoxMargin * std::max(largest, rays.unitMeters());
        box.low -= margin;
        box.high += margin;
        all.add(box.low);
        all.add(box.high);
        boxes_.push_back(box);
    }
    if (boxes_.size() > kMaxBoxes) boxes_.assign(1, all);
}

bool ShiningBounds::mayMeet(const Ray& ray) const {
    if (anywhere_) return true;
    for (const Bounds& box : boxes_)
        if (meets(box, ray)) return true;
    return false;
}

/// One round of an estimate.
struct AreaIrradianceSampler::Round {
    int lightSamples = 0, cosineSamples = 0;
    ShadowRays shadowRays = ShadowRays::all;
    glm::vec3 light{0};    // W/m2
    int contributing = 0;  // light samples that were traced and contribute unless they are occluded
    int visible = 0;       // and are not occluded
    uint64_t rays = 0;
};

struct AreaIrradianceSampler::Receiver {
    glm::vec3 position, origin;  // `origin`: off the surface
    Frame frame;
};

void AreaIrradianceSampler::addLightSamples(const Receiver& at, int firstTraced, Rng& rng,
                                            Round& round) const {
    const float choiceShift = rng.uniform();
    const glm::vec2 squareShift = rng.uniform2();
    const bool sparse = round.shadowRays == ShadowRays::sparse;
    for (int i = 0; i < round.lightSamples; ++i) {
        const float choice = (float(i) + choiceShift) / float(round.lightSamples);
        const LightSample light =
            scene_.lights.sampleArea(at.position, choice, glm::fract(squareShift + float(i) * kR2));
        const float cosine = glm::dot(light.towardLight, at.frame.normal);
        if (light.pdf <= 0.0f || cosine <= 0.0f) continue;
        // Both strategies' samples share one sum: value / (n_1 p_1 + n_2 p_2).
        const float weight =
            cosine / (float(round.lightSamples) * light.pdf + float(round.cosineSamples) * cosine / kPi);
        if (maxComponent(light.radiance) <= 0.0f) continue;
        if (sparse) round.light += weight * light.radiance;
        if (sparse && i % kSparseShadowRays != firstTraced) continue;
        ++round.contributing;
        const glm::vec3 transmittance =
            transmittanceToLight(scene_.rays, at.position, at.origin, light, round.rays);
        if (sparse)
            round.light -=
                float(kSparseShadowRays) * weight * (glm::vec3(1) - transmittance) * light.radiance;
        if (maxComponent(transmittance) <= 0.0f) continue;
        ++round.visible;
        if (!sparse) round.light += weight * transmittance * light.radiance;
    }
}

void AreaIrradianceSampler::addCosineSamples(const Receiver& at, Rng& rng, Round& round) const {
    const glm::vec2 cosineShift = rng.uniform2();
    for (int i = 0; i < round.cosineSamples; ++i) {
        const glm::vec3 local = squareToCosineHemisphere(glm::fract(cosineShift + float(i) * kR2));
        if (local.z <= 0.0f) continue;
        const Ray ray{at.origin, at.frame.toWorld(local)};
        if (!shining_.mayMeet(ray) && scene_.lights.sampleEnvironmentPdf(ray.direction) <= 0.0f) continue;
        ++round.rays;
        const StraightView view = seeStraight(scene_.rays, ray, kFarDistance, round.rays);
        const float pdf = areaPdf(scene_.lights, at.position, view.hit, ray.direction);
        if (pdf <= 0.0f) continue;
        const float weight =
            local.z / (float(round.lightSamples) * pdf + float(round.cosineSamples) * local.z / kPi);
        round.light += weight * view.transmittance * emissionToward(scene_, view.hit, ray.direction);
    }
}

IrradianceEstimate AreaIrradianceSampler::areaIrradiance(glm::vec3 position, glm::vec3 normal,
                                                         const IrradianceSampling& sampling,
                                                         ShadowRays shadowRays, Rng rng,
                                                         uint64_t& rayCount) const {
    assert(sampling.rounds >= 2);
    const int rounds = sampling.rounds;
    const Receiver at{position, scene_.rays.offsetOrigin(position, normal), frameFromNormal(normal)};
    // By a copy: the samples are those of ShadowRays::all, and so is the estimate where all of them are seen.
    const int firstTraced = int(hashOf(Rng(rng).bits()) % uint64_t(kSparseShadowRays));
    glm::vec3 sum(0);
    double luminances = 0, squares = 0;
    int contributing = 0, visible = 0;
    for (int i = 0; i < rounds; ++i) {
        Round round{sampling.lightSamplesPerRound, std::max(sampling.lightSamplesPerRound / 2, 1),
                    shadowRays};
        addLightSamples(at, (firstTraced + i) % kSparseShadowRays, rng, round);
        addCosineSamples(at, rng, round);
        const double value = luminance(round.light);
        sum += round.light;
        luminances += value;
        squares += value * value;
        contributing += round.contributing;
        visible += round.visible;
        rayCount += round.rays;
    }
    const double spread = std::max(squares - luminances * luminances / rounds, 0.0);
    return {sum / float(rounds), float(spread / (double(rounds) * (rounds - 1))),
            visible > 0 && visible < contributing};
}

IrradianceEstimate areaIrradiance(const LitScene& scene, glm::vec3 position, glm::vec3 normal,
                                  const IrradianceSampling& sampling, Rng rng, uint64_t& rayCount) {
    return AreaIrradianceSampler(scene).areaIrradiance(position, normal, sampling, ShadowRays::all, rng,
                                                       rayCount);
}

}  // namespace phat
