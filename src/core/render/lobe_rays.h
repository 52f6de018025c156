#pragma once
// The rays of one lobe of one pixel. See traced_reflections.h.

#include "core/render/hit_gloss.h"
#include "core/render/traced_reflections.h"
#include "core/scene/glass.h"

namespace phat {

/// The points of Sobol's sequence that a pixel's rays take.
struct RayNumbers {
    uint32_t seed = 0;
    uint32_t first = 0, stride = 1;

    glm::vec2 of(int ray) const;
};

/// What the rays of a lobe found.
struct TracedLight {
    PooledLight light;
    HitGloss gloss;  // apart from `light`
};

/// A lobe as a surface of its own.
struct LobeRays {
    const ReflectionScene& scene;
    const ReflectionView& view;
    uint64_t& rayCount;
    SurfacePoint point;
    glm::vec3 eyeLocal{0};
    float albedo = 0;
    ReflectionPool::Steps steps{};  // to the next pixels

    /// `walks`: from each glossy hit. `stream` seeds all other random numbers.
    TracedLight trace(int count, int walks, const RayNumbers& numbers, uint64_t stream) const;

  private:
    SurfacePoint surfaceOf(const SeenThrough& seen) const;
    glm::vec3 estimateByLightSample(Rng& rng) const;
};

}  // namespace phat
