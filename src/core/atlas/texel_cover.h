#pragma once
// Whether a point on a surface is inside or pressed against other geometry.

#include "core/base/hemisphere_map.h"
#include "core/base/random.h"
#include "core/scene/glass.h"
#include "core/scene/rays.h"

namespace phat {

/// A point from which the hemisphere around the frame's normal is looked at.
struct CoverPoint {
    glm::vec3 origin{0};
    Frame frame;
    float texelSizeMeters = 0;
    uint64_t seed = 0;
};

/// At least half of the rays meet dark sides, or nine tenths of the hemisphere, by cosine, are blocked less
/// than a quarter of a texel above the surface. `isDark(hit)`: whether that side has no texels.
template <typename IsDark>
bool isCovered(const CoverPoint& point, const RayScene& rays, const IsDark& isDark) {
    constexpr int kStrata = 4;  // per axis: 16 rays
    constexpr int kRays = kStrata * kStrata;
    // Half of the rays meet unlit backs: the texel is inside or under an object. For texels beside a wall's
    // foot it is at most a little less than half.
    constexpr int kMaxDeadRays = kRays / 2;
    // An object touches the surface. Height instead of distance, weighted by cosine, so that the border of
    // the contact is not speckled.
    constexpr float kMaxBlocked = 0.9f;
    constexpr float kPressedTexels = 0.25f;

    Rng rng(point.seed);
    const glm::vec2 shift = rng.uniform2();
    int dead = 0;
    float blocked = 0, sky = 0;
    uint64_t rayCount = 0;
    for (int ray = 0; ray < kRays; ++ray) {
        const glm::vec2 stratum(float(ray % kStrata), float(ray / kStrata));
        const glm::vec3 local = squareToHemisphere(glm::fract((stratum + shift) / float(kStrata)));
        // What lies under or in glass is lit through it.
        const Ray toward{point.origin, glm::normalize(point.frame.toWorld(local))};
        const Hit hit = seeStraight(rays, toward, kFarDistance, rayCount).hit;
        sky += local.z;
        if (!hit) continue;
        dead += isDark(hit);
        if (hit.distance * local.z < kPressedTexels * point.texelSizeMeters) blocked += local.z;
    }
    return dead >= kMaxDeadRays || blocked >= kMaxBlocked * sky;
}

}  // namespace phat
