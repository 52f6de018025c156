#include "core/scene/lights.h"

#include <cassert>

#include "core/scene/length_unit.h"
#include "core/scene/light_punctual.h"

namespace phat {
namespace {

constexpr float kInfinityMeters = 1e30f;

// Share of sampleArea that the environment and the triangles each keep where both shine: power says little
// about who reaches a point, a small emitter indoors must be sampled beside a bright sky. ours, untuned.
constexpr float kMinSourceProbability = 0.1f;

// Cosines below this are edge-on: nothing is sampled and nothing counts as sampled.
constexpr float kMinCosine = 1e-6f;

float emittingCosine(const EmissiveTriangle& emitter, glm::vec3 towardPoint) {
    const float cosine = glm::dot(emitter.normal, towardPoint);
    return emitter.doubleSided ? std::abs(cosine) : cosine;
}

}  // namespace

LightSampler::LightSampler(const Scene& scene, SharedValue<Environment> environment)
    : scene_(&scene), sky_(std::move(environment)), emitters_(findEmissiveTriangles(scene)) {
    if (const Bounds bounds = boundsOf(scene); !bounds.empty()) {
        sceneCenter_ = bounds.center();
        sceneRadius_ = 0.5f * bounds.diagonal();
        unitMeters_ = lengthUnit(scene);
    }
    for (const PunctualLight& light : scene.lights) {
        powerPunctual_ += punctualPower(light, sceneRadius_);
        hasDiscs_ = hasDiscs_ || light.angularRadius > 0;
    }

    std::vector<double> weights(emitters_.size());
    glm::dvec3 emittersWatts(0);
    if (!emitters_.empty()) emitterOfTriangle_.assign(scene.triangles.size(), kNoTriangle);
    for (size_t i = 0; i < emitters_.size(); ++i) {
        const glm::vec3 power = emitters_[i].power();
        emitterOfTriangle_[emitters_[i].triangle] = uint32_t(i);
        weights[i] = luminance(power);
        emittersWatts += glm::dvec3(power);
    }
    emitterChoice_ = DiscreteDistribution(weights);

    glm::vec3 environmentWatts(0);
    if (sky_ && sky_->radiance.width > 0 && sky_->radiance.height > 0) {
        environment_.emplace(*sky_);
        environmentWatts = kPi * square(sceneRadius_) * environment_->integratedRadiance();
    }
    powerArea_ = glm::vec3(emittersWatts) + environmentWatts;
    if (environment_ && !environment_->black()) {
        const float probability = luminance(environmentWatts) / luminance(powerArea_);
        environmentChance_ =
            emitters_.empty() ? 1.0f
                              : std::clamp(probability, kMinSourceProbability, 1.0f - kMinSourceProbability);
    }
    addPhotonSources();
}

bool LightSampler::empty() const {
    return !hasPunctual() && !hasArea();
}

bool LightSampler::hasPunctual() const {
    return !scene_->lights.empty();
}

bool LightSampler::hasArea() const {
    return !emitters_.empty() || environmentChance_ > 0;
}

glm::vec3 LightSampler::powerPunctual() const {
    return powerPunctual_;
}

glm::vec3 LightSampler::powerArea() const {
    return powerArea_;
}

LightSample LightSampler::sampleArea(glm::vec3 point, float choice, glm::vec2 square) const {
    if (!hasArea()) return {};
    LightSample sample;
    if (choice < environmentChance_) {
        const EnvironmentSample found = environment_->sample(square);
        if (!(found.pdf > 0)) return {};
        sample.towardLight = found.direction;
        sample.distance = kInfinityMeters;
        sample.radiance = environmentRadiance(found.direction);
        sample.pdf = environmentChance_ * found.pdf;
        return sample;
    }
    if (emitters_.empty()) return {};

    // `choice` has 24 bits, too coarse for the small ones of many triangles: the square's bits add the next.
    const uint64_t fine = hashOf(uint64_t(square.x * 0x1p24f), uint64_t(square.y * 0x1p24f));
    const double unit = double(choice) + double(fine >> 40) * 0x1p-48;
    const double chance = 1.0 - double(environmentChance_);
    const size_t index =
        emitterChoice_.choose(std::max(0.0, unit - double(environmentChance_)) / chance).index;
    const EmissiveTriangle& emitter = emitters_[index];
    const glm::vec2 barycentric = squareToTriangle(square);
    const glm::vec3 toward = pointOnTriangle(*scene_, emitter.triangle, barycentric) - point;
    const float distanceSquared = glm::dot(toward, toward);
    if (!(distanceSquared > 0)) return {};
    sample.distance = std::sqrt(distanceSquared);
    sample.towardLight = toward / sample.distance;
    sample.triangle = emitter.triangle;
    const float cosine = emittingCosine(emitter, -sample.towardLight);
    if (!(cosine > kMinCosine)) return {};
    sample.radiance = emitter.uniform ? emitter.radiance : emittedRadiance(*scene_, emitter, barycentric);
    sample.pdf = float(chance * emitterChoice_.probability(index)) * distanceSquared /
                 (cosine * emitter.areaSquareMeters);
    return sample;
}

float LightSampler::sampleAreaPdf(glm::vec3 point, const Hit& hit, glm::vec3 direction) const {
    if (!hit || emitters_.empty() || emitterOfTriangle_[hit.triangle] == kNoTriangle) return 0.0f;
    const size_t index = emitterOfTriangle_[hit.triangle];
    const EmissiveTriangle& emitter = emitters_[index];
    const float cosine = emittingCosine(emitter, -direction);
    if (!(cosine > kMinCosine)) return 0.0f;
    const glm::vec3 toward = pointOnTriangle(*scene_, hit.triangle, hit.barycentric) - point;
    return (1.0f - environmentChance_) * float(emitterChoice_.probability(index)) * glm::dot(toward, toward) /
           (cosine * emitter.areaSquareMeters);
}

float LightSampler::sampleEnvironmentPdf(glm::vec3 direction) const {
    return environment_ ? environmentChance_ * environment_->pdf(direction) : 0.0f;
}

glm::vec3 LightSampler::environmentRadiance(glm::vec3 direction) const {
    return environment_ ? phat::environmentRadiance(*sky_, direction) : glm::vec3(0);
}

LightSample LightSampler::samplePunctual(size_t index, glm::vec3 point, glm::vec2 square) const {
    assert(index < scene_->lights.size());
    const PunctualLight& light = scene_->lights[index];
    LightSample sample;
    sample.delta = true;
    if (light.type == PunctualLight::Type::directional) {
        sample.towardLight = sampleLightDisc(light, square);
        sample.distance = kInfinityMeters;
        sample.radiance = light.intensity;
        sample.pdf = 1.0f;
        return sample;
    }
    const glm::vec3 toward = light.position - point;
    const float distanceSquared = glm::dot(toward, toward);
    if (!(distanceSquared > phat::square(kMinLightDistance * sceneRadius_))) return sample;
    sample.distance = std::sqrt(distanceSquared);
    sample.towardLight = toward / sample.distance;
    float attenuation = rangeAttenuation(sample.distance, light.rangeMeters);
    if (light.type == PunctualLight::Type::spot) {
        attenuation *= spotFalloff(spotCone(light), glm::dot(light.direction, -sample.towardLight));
    }
    if (light.photometry) attenuation *= photometricFalloff(light, -sample.towardLight);
    if (!(attenuation > 0)) return sample;
    sample.radiance = light.intensity * (attenuation / distanceSquared);
    sample.pdf = 1.0f;
    return sample;
}

}  // namespace phat
