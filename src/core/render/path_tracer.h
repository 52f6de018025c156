#pragma once
// The reference: every other renderer's picture should be this one's, without noise.

#include "core/render/picture.h"
#include "core/scene/lights.h"
#include "core/scene/rays.h"
#include "core/transport/path_guide.h"

namespace phat {

/// Unbiased path tracing of the bake's scene, materials and lights (tracePath in core/transport/path.h).
/// Paths end by Russian roulette; the cap of kMaxPathBounces matters only where albedos exceed .97 all round.
/// `rays` and `lights` must outlive it.
Integrator pathTracer(const RayScene& rays, const LightSampler& lights, Component component);

/// The same with the materials of `viewedScene` on directly visible surfaces, and those of the ray scene
/// wherever light goes from there: materials that were changed after a bake, in the light of before. `guide`
/// takes noise out of indirect light and may be null. pre: `viewedScene` is the ray scene's but for
/// materials; both outlive the integrator.
Integrator pathTracer(const RayScene& rays, const LightSampler& lights, Component component,
                      const Scene& viewedScene, const PathGuide* guide = nullptr);

/// A guide from photons, whose number is in proportion to that of the paths; empty for few paths.
PathGuide learnGuide(const RayScene& rays, const LightSampler& lights, double paths, uint64_t seed,
                     Progress& progress);

inline constexpr int kMaxPathBounces = 256;

}  // namespace phat
