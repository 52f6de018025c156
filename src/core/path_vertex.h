#pragma once
// One vertex of a path: what all that trace paths share.

#include "core/lights.h"
#include "core/random.h"
#include "core/rays.h"
#include "core/shading.h"

namespace phat {

/// Where a ray along `direction` starts.
glm::vec3 originOn(const SurfacePoint& point, glm::vec3 direction);

/// A direction that the shading normal allows may still point into the flat triangle: light does not pass.
bool leavesSurface(const SurfacePoint& point, glm::vec3 direction);

/// Radiance that `point` reflects of the punctual lights, by shadow rays: to each of a few, or to one of many that
/// is chosen by what it would bring.
glm::vec3 punctualLight(const RayScene& rays, const LightSampler& lights, const SurfacePoint& point,
                        glm::vec3 towardEye, Rng& rng, uint64_t& rayCount);

/// The same of one place on the area lights, weighed against sampleBrdf by the balance heuristic (Veach
/// 1997).
glm::vec3 areaLight(const RayScene& rays, const LightSampler& lights, const SurfacePoint& point,
                    glm::vec3 towardEye, Rng& rng, uint64_t& rayCount);

/// Density with which areaLight finds what a ray hit, 1/sr.
float areaPdf(const LightSampler& lights, glm::vec3 from, const Hit& hit, glm::vec3 direction);

/// Russian roulette: the chance of going on after reflection number `bounce`, counted from 0.
float survivalChance(int bounce, glm::vec3 throughput);

}  // namespace phat
