#include "core/scene/light_punctual.h"

#include "core/scene/brdf.h"

namespace phat {
namespace {

// A hard edge must not divide by zero. Three steps of a float below 1; the extension's example code has
// .001, which is all of a cone of less than 2.6 degrees and contradicts its text: within the inner cone
// nothing falls off. twin: kMinConeWidth in shaders/lib/lights.glsl.
constexpr float kMinConeWidth = 2e-7f;

// 1 at cosine base + width, clipped where that lies beyond the axis (cones narrower than the least width).
struct ConeMass {
    float ring = 0;  // of the falloff over the cosine, the soft part
    float cap = 0;   // the full part
};

ConeMass massOf(const SpotCone& cone) {
    const float softEnd = std::min(cone.width, 1.0f - cone.base);
    return {softEnd * square(softEnd / cone.width) / 3.0f, std::max(0.0f, 1.0f - (cone.base + cone.width))};
}

// In which Photometry has its directions.
Frame photometricFrame(const PunctualLight& light) {
    return {light.horizontalZero, glm::cross(light.horizontalZero, light.direction), -light.direction};
}

}  // namespace

float rangeAttenuation(float distanceMeters, float rangeMeters) {
    if (!(rangeMeters > 0)) return 1.0f;
    const float ratio = distanceMeters / rangeMeters;
    return std::clamp(1.0f - square(square(ratio)), 0.0f, 1.0f);
}

SpotCone spotCone(const PunctualLight& spot) {
    return {spot.cosOuterCone, std::max(kMinConeWidth, spot.cosInnerCone - spot.cosOuterCone)};
}

float spotFalloff(const SpotCone& cone, float cosAngle) {
    return square(std::clamp((cosAngle - cone.base) / cone.width, 0.0f, 1.0f));
}

float spotSolidAngle(const SpotCone& cone) {
    const ConeMass mass = massOf(cone);
    return 2 * kPi * (mass.ring + mass.cap);
}

float sampleSpotCosine(const SpotCone& cone, float unit) {
    const ConeMass mass = massOf(cone);
    const float target = unit * (mass.ring + mass.cap);
    if (target >= mass.ring) return std::min(1.0f, cone.base + cone.width + (target - mass.ring));
    return std::min(1.0f, cone.base + std::cbrt(3.0f * square(cone.width) * target));
}

float photometricFalloff(const PunctualLight& light, glm::vec3 direction) {
    return light.photometry->at(photometricFrame(light).toLocal(direction));
}

glm::vec3 samplePhotometry(const PunctualLight& light, glm::vec2 square) {
    return photometricFrame(light).toWorld(light.photometry->sample(square));
}

float litCosine(const PunctualLight& light) {
    if (light.type == PunctualLight::Type::spot) return light.cosOuterCone;
    return light.photometry ? light.photometry->darkBelowCosine() : -1.0f;
}

glm::vec3 sampleLightDisc(const PunctualLight& light, glm::vec2 square) {
    if (light.angularRadius <= 0) return -light.direction;
    // The cosine-weighted hemisphere is the uniform disc lifted up (Malley's method).
    const glm::vec2 disc = std::tan(light.angularRadius) * glm::vec2(squareToCosineHemisphere(square));
    const Frame frame = frameFromNormal(-light.direction);
    return glm::normalize(frame.toWorld({disc, 1}));
}

glm::vec3 punctualPower(const PunctualLight& light, float sphereRadiusMeters) {
    switch (light.type) {
        case PunctualLight::Type::point:
            return (light.photometry ? light.photometry->solidAngle() : 4 * kPi) * light.intensity;
        case PunctualLight::Type::spot:
            return spotSolidAngle(spotCone(light)) * light.intensity;
        case PunctualLight::Type::directional:
            return kPi * square(sphereRadiusMeters) * light.intensity;
    }
    return glm::vec3(0);
}

}  // namespace phat
