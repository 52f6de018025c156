#pragma once
// A clear sky and the sun.
//
// source: Preetham, Shirley and Smits 1999, "A Practical Analytic Model for Daylight": the sky's luminance
// and chromaticity (appendix A.2) and the sun's attenuation (A.1). Luminances are divided by 683 lm/W, so
// that they are in this program's W (scene.h): 683 nit are 1 W/(m2 sr).

#include "core/scene/scene.h"
#include "core/scene/sun_position.h"

namespace phat {

/// The model was fitted to turbidities from 2 (very clear) to 6 (hazy); below 2 it has no meaning.
inline constexpr float kMinTurbidity = 2, kMaxTurbidity = 10;

/// pre: the sun is above the horizon, the turbidity within the bounds above.
struct Daylight {
    SunPosition sun;
    float turbidity = 3;
};

/// Radiance of the sky without the sun. pre: `direction` is unit and not below the horizon.
glm::vec3 skyRadiance(const Daylight& day, glm::vec3 direction);

/// The sun's irradiance on a plane that faces it, W/m2.
glm::vec3 sunIrradiance(const Daylight& day);

/// The sun's disc as seen from the earth, in the mean over the year: half of .533 degrees.
inline constexpr float kSunAngularRadius = 0.00465f;

/// The sun as a light of its own: directional, a disc of kSunAngularRadius.
PunctualLight sunLight(const Daylight& day);

/// The sky, and below the horizon a plain of reflectance kGroundReflectance in its and the sun's light.
Environment skyEnvironment(const Daylight& day);

inline constexpr float kGroundReflectance = 0.2f;

}  // namespace phat
