#pragma once
// Whether a point on a surface is inside or pressed against other geometry.

#include "core/base/hemisphere_map.h"
#include "core/base/random.h"
#include "core/scene/glass.h"
#include "core/scene/rays.h"

namespace phat {

inline constexpr float kPressedTexels = 0.25f;  // above a surface: what touches it
inline constexpr float kMaxDark = 0.5f, kMaxBlocked = 0.9f;

/// A point from which the hemisphere around the frame's normal is looked at.
struct CoverPoint {
    glm::vec3 origin{0};
    Frame frame;
    float touchMeters = 0;  // what is less than this above the surface touches it
    uint64_t seed = 0;
};

/// How much of the hemisphere over a point is closed.
struct Cover {
    float dark = 0;     // fraction of the directions in which dark sides are met
    float touched = 0;  // fraction, by cosine, that is blocked by what touches the surface
    float sky = 0;      // fraction of the directions in which nothing is met

    /// Whether the point is inside other geometry, or an object touches it. A texel that is inside meets
    /// unlit backs everywhere, but corners of texels may be outside; beside a wall's foot it meets at most a
    /// little less than half. Height instead of distance, weighted by cosine, so that the border of a contact
    /// is not speckled.
    bool closed() const { return dark >= kMaxDark || touched >= kMaxBlocked; }
};

/// `isDark(hit)`: whether that side has no texels.
template <typename IsDark>
Cover coverOf(const CoverPoint& point, const RayScene& rays, const IsDark& isDark) {
    constexpr int kStrata = 4;  // per axis: 16 rays
    constexpr int kRays = kStrata * kStrata;
    Rng rng(point.seed);
    const glm::vec2 shift = rng.uniform2();
    int dead = 0, free = 0;
    float blocked = 0, all = 0;
    uint64_t rayCount = 0;
    for (int ray = 0; ray < kRays; ++ray) {
        const glm::vec2 stratum(float(ray % kStrata), float(ray / kStrata));
        const glm::vec3 local = squareToHemisphere(glm::fract((stratum + shift) / float(kStrata)));
        // What lies under or in glass is lit through it.
        const Ray toward{point.origin, glm::normalize(point.frame.toWorld(local))};
        const Hit hit = seeStraight(rays, toward, kFarDistance, rayCount).hit;
        all += local.z;
        free += !hit;
        if (!hit) continue;
        dead += isDark(hit);
        if (hit.distance * local.z < point.touchMeters) blocked += local.z;
    }
    return {float(dead) / kRays, blocked / all, float(free) / kRays};
}

}  // namespace phat
