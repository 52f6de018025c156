#pragma once
// Formulas of glTF's punctual lights. source: KHR_lights_punctual.
// twin: the direct light of the run-time shaders.

#include "core/scene/scene.h"

namespace phat {

/// Nearer than this part of the scene's radius a point light has no direction to speak of, and its irradiance
/// might overflow.
inline constexpr float kMinLightDistance = 2.5e-7f;

/// Share of a light's intensity left at `distance`, 1 when its range is unlimited (rangeMeters = 0).
float rangeAttenuation(float distanceMeters, float rangeMeters);

/// A spot light's falloff over the cosine between its axis and the way to the receiver:
/// saturate((cos - base) / width)^2.
struct SpotCone {
    float base = 0;   // cosine where light begins
    float width = 1;  // in cosine, up to full light
};
SpotCone spotCone(const PunctualLight& spot);
float spotFalloff(const SpotCone& cone, float cosAngle);
/// Integral of the falloff over the sphere, sr.
float spotSolidAngle(const SpotCone& cone);
/// Cosine distributed as the falloff: pdf over directions = spotFalloff / spotSolidAngle.
float sampleSpotCosine(const SpotCone& cone, float unit);

/// Share of the peak's intensity that a light with photometry has in a direction of propagation.
float photometricFalloff(const PunctualLight& light, glm::vec3 direction);
/// A direction distributed as that falloff.
glm::vec3 samplePhotometry(const PunctualLight& light, glm::vec2 square);
/// The least cosine with its direction at which a point or spot light shines; -1: it may be any.
float litCosine(const PunctualLight& light);

/// Direction toward a point of a directional light's disc, uniform over the disc; toward its middle where it
/// has no size.
glm::vec3 sampleLightDisc(const PunctualLight& light, glm::vec2 square);

/// Emitted power in W, as if the range were unlimited. Directional lights: what enters a sphere of this
/// radius.
glm::vec3 punctualPower(const PunctualLight& light, float sphereRadiusMeters);

}  // namespace phat
