#pragma once
// What the glossy lobes of the surfaces that reflection rays hit reflect back, apart from all else: it is an
// estimate by a few walks. A mirror shows one point of them in each pixel, and its neighbours' rays do not
// count for it, but what they hit is near, and the lobes there are alike. So pixels share the light on these
// lobes, as they share the light on those that are seen directly. ours, because mirrors showed rough metals
// with the noise of the walks.

#include "core/bake/irradiance_ray.h"
#include "core/render/reflection_pool.h"

namespace phat {

/// Which side of a surface a hit is on, of PooledLobe.
uint32_t sideOf(const Scene& scene, const Hit& hit);

/// What a ray met.
struct GlossyHit {
    uint32_t side = 0;
    glm::vec3 arriving{0};  // the ray's direction
    const SurfacePoint& point;
    const HitReflection& reflected;
};

/// Of the rays of one lobe.
struct HitGloss {
    PooledLobe lobe;       // what they hit in the mean; alpha 0: nothing glossy. The pixel is the caller's.
    PooledLight light;     // incident light under it is `indirect`
    glm::vec3 carried{0};  // the part of that light that arrives at the lobe the rays belong to
};

/// Adds up the hits on one side of one surface: that of the first.
class HitGlossSum {
  public:
    /// Whether the hit is one of them; else its light must be counted by the caller. `weight`: the ray's.
    bool add(const GlossyHit& hit, glm::vec3 weight);
    /// `weights`: the sum over all rays.
    HitGloss mean(float weights) const;

  private:
    PooledLobe sum_{.towardEye = glm::vec3(0)};  // times the weight of each, `distance` its inverse
    glm::vec3 light_{0}, albedo_{0};
    float weight_ = 0;
    int walks_ = 0;
};

}  // namespace phat
