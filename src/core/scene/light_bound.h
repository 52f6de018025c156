#pragma once
// How bright a scene can be.

#include "core/scene/scene.h"

namespace phat {

/// Of a radiance that nothing bounds.
inline constexpr float kUnbounded = 1e30f;

/// Whether anything that emits also reflects. Light is what a surface emits plus what it reflects; where all
/// that emits is black, one of the two is zero. The environment is black in this sense.
bool emittersReflect(const Scene& scene);

/// Where nothing shines brighter than the brightest emission: that, by channel; else, and where nothing
/// emits, a bound beyond all light.
/// No path through surfaces that reflect at most what they receive ends on more, if all that emits is black
/// (but for grazing Fresnel, under .4 % of the hemisphere's light). A punctual light may come near enough to
/// exceed any bound.
glm::vec3 brightestRadiance(const Scene& scene);

/// Mean luminance of the environment over the sphere of directions; 0 without one.
double meanEnvironmentLuminance(const Scene& scene);

}  // namespace phat
