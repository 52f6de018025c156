#pragma once
// Whether light comes to what a camera sees.

#include "core/scene/lights.h"
#include "core/scene/rays.h"

namespace phat {

/// Of the surfaces that are seen, the fraction that daylight meets, directly or after up to six diffuse
/// reflections; 1 where nothing is seen. Nothing of the scene's own light is asked.
float daylightFraction(const RayScene& rays, const Camera& camera);

/// Of the surfaces that are seen and do not shine themselves, the fraction that the scene's lights reach
/// directly; 1 where none is seen.
float litFraction(const RayScene& rays, const LightSampler& lights, const Camera& camera);

}  // namespace phat
