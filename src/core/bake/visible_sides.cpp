#include "core/bake/visible_sides.h"

#include <tbb/parallel_for.h>

#include <algorithm>

#include "core/base/discrete_distribution.h"
#include "core/base/random.h"
#include "core/scene/brdf.h"
#include "core/scene/camera_ray.h"
#include "core/scene/enclosure.h"
#include "core/scene/glass.h"
#include "core/scene/triangle_corners.h"

namespace phat {
namespace {

// A walk from a side meets so many surfaces, and looks from each point at so many eyes.
constexpr int kWalkBounces = 4, kWalkEyes = 2;
// Of kSideRays walks from a side, those that have to end at an eye or at light. Through a crack of a
// millimetre in a wall of two metres half a walk does, in the mean.
constexpr uint32_t kVisible = 4, kClearlyVisible = 20;
// Rays that tell whether an eye is outside: more than this part of them meets nothing.
constexpr int kEyeRays = 128;
constexpr float kOutside = 0.5f;
// What a ray passes, at most, of what moves.
constexpr int kMaxPassed = 16;

constexpr uint32_t kRests = ~0u, kPassesNothing = ~0u - 1;

/// Where eyes and lights may be.
std::vector<glm::vec3> eyesOf(const Scene& scene, const std::vector<StandPoint>& stands) {
    std::vector<glm::vec3> eyes;
    for (const StandPoint& stand : stands) eyes.push_back(stand.eye);
    for (const Camera& camera : scene.cameras) eyes.push_back(glm::vec3(camera.worldFromCamera[3]));
    for (const PunctualLight& light : scene.lights)
        if (light.type != PunctualLight::Type::directional) eyes.push_back(light.position);
    return eyes;
}

bool hasDirectionalLight(const Scene& scene) {
    return std::any_of(scene.lights.begin(), scene.lights.end(), [](const PunctualLight& light) {
        return light.type == PunctualLight::Type::directional;
    });
}

/// [surface]: the nearest node above it, or its own, that an animation moves; kRests where there is none.
std::vector<uint32_t> moversOf(const Scene& scene) {
    std::vector<uint8_t> moves(scene.nodes.size(), 0);
    for (const Animation& animation : scene.animations)
        for (const AnimationChannel& channel : animation.channels) moves[channel.node] = 1;
    std::vector<uint32_t> movers;
    for (const Surface& surface : scene.surfaces) {
        auto node = surface.node < scene.nodes.size() ? int32_t(surface.node) : -1;
        while (node >= 0 && !moves[size_t(node)]) node = scene.nodes[size_t(node)].parent;
        movers.push_back(node < 0 ? kRests : uint32_t(node));
    }
    return movers;
}

glm::vec3 faceNormal(const Scene& scene, uint32_t triangle) {
    const auto [a, b, c] = cornersOf(scene, triangle);
    return glm::normalize(glm::cross(b - a, c - a));
}

/// Walks from sides to where eyes and lights may be.
class Walks {
  public:
    explicit Walks(const LitScene& lit)
        : lit_(lit), components_(findComponents(lit.rays.scene())), movers_(moversOf(lit.rays.scene())) {
        const std::vector<StandPoint> stands = standPointsOfAllStoreys(lit.rays);
        eyes_ = eyesOf(lit.rays.scene(), stands);
        aroundIsOpen_ =
            stands.empty() || hasDirectionalLight(lit.rays.scene()) ||
            std::any_of(eyes_.begin(), eyes_.end(), [&](glm::vec3 eye) { return isOutside(eye); });
    }
    const Components& components() const { return components_; }

    /// Per side: how many of kSideRays walks end well, with all that moves where it is or away. None of
    /// single-sided surfaces, which have texels in any case.
    std::vector<uint32_t> ofSides() const {
        const Scene& scene = lit_.rays.scene();
        const bool moves =
            std::any_of(movers_.begin(), movers_.end(), [](uint32_t m) { return m != kRests; });
        std::vector<uint32_t> ended(2 * size_t(components_.count()), 0);
        tbb::parallel_for(uint32_t(0), uint32_t(ended.size()), [&](uint32_t s) {
            if (!isSide(scene, components_, s | 1)) return;
            ended[s] = walksFrom(s, kPassesNothing);
            if (!moves) return;
            const uint32_t triangle = components_.triangle[components_.first[s / 2]];
            ended[s] = std::max(ended[s], walksFrom(s, movers_[scene.triangleSurface[triangle]]));
        });
        return ended;
    }

  private:
    // `mover`: of the surface that the ray leaves, all else that moves is away; kPassesNothing: it is not.
    Hit meets(Ray ray, uint32_t mover, float maxDistance = kFarDistance) const {
        const Scene& scene = lit_.rays.scene();
        Hit hit;
        float way = 0;
        for (int passed = 0; passed < kMaxPassed; ++passed) {
            uint64_t rayCount = 0;
            hit = seeStraight(lit_.rays, ray, maxDistance - way, rayCount).hit;
            if (!hit) break;
            const uint32_t met = movers_[scene.triangleSurface[hit.triangle]];
            if (mover == kPassesNothing || met == kRests || met == mover) break;
            way += hit.distance;
            ray.origin = lit_.rays.offsetOrigin(ray.origin + hit.distance * ray.direction, ray.direction);
        }
        if (hit) hit.distance += way;
        return hit;
    }

    bool isOutside(glm::vec3 eye) const {
        int nothing = 0;
        for (int i = 0; i < kEyeRays; ++i) nothing += !meets({eye, spherePoint(i, kEyeRays)}, kPassesNothing);
        return float(nothing) > kOutside * kEyeRays;
    }

    // Near eyes are tried more often: one may be in a small space.
    bool seesEye(glm::vec3 from, uint32_t mover, Rng& random) const {
        if (eyes_.empty()) return false;
        std::vector<double> nearness;
        for (const glm::vec3& eye : eyes_)
            nearness.push_back(1 / std::max(double(glm::dot(eye - from, eye - from)), 1e-12));
        const DiscreteDistribution choice(nearness);
        for (int i = 0; i < kWalkEyes; ++i) {
            const glm::vec3 toward = eyes_[choice.choose(double(random.uniform())).index] - from;
            const float distance = glm::length(toward);
            if (distance > 0 && !meets({from, toward / distance}, mover, distance)) return true;
        }
        return false;
    }

    // Whether a walk ends at an eye or at light.
    bool endsWell(Ray ray, uint32_t mover, Rng& random) const {
        const Scene& scene = lit_.rays.scene();
        for (int bounce = 0; bounce < kWalkBounces; ++bounce) {
            const Hit hit = meets(ray, mover);
            if (!hit)
                return aroundIsOpen_ || maxComponent(lit_.lights.environmentRadiance(ray.direction)) > 0;
            if (isCulled(scene, hit)) return false;
            if (maxComponent(scene.materialOf(hit.triangle).emission) > 0) return true;
            const glm::vec3 normal = faceNormal(scene, hit.triangle) * (hit.backFace ? -1.0f : 1.0f);
            ray.origin = lit_.rays.offsetOrigin(ray.origin + hit.distance * ray.direction, normal);
            if (mover != kPassesNothing) mover = movers_[scene.triangleSurface[hit.triangle]];
            if (seesEye(ray.origin, mover, random)) return true;
            const glm::vec3 local = squareToCosineHemisphere(random.uniform2());
            ray.direction = glm::normalize(frameFromNormal(normal).toWorld(local));
        }
        return false;
    }

    uint32_t walksFrom(uint32_t side, uint32_t mover) const {
        uint32_t walk = 0;
        const auto met = [&](const Ray& ray) {
            Rng random(hashOf(0x3a1c, side, walk++));
            return endsWell(ray, mover, random) ? kMeetsLight : kMeetsNothing;
        };
        const std::vector<uint32_t> ends = meetsFromSide(lit_.rays, components_, side, met);
        return uint32_t(std::count(ends.begin(), ends.end(), kMeetsLight));
    }

    LitScene lit_;
    Components components_;
    std::vector<uint32_t> movers_;  // [surface]
    std::vector<glm::vec3> eyes_;
    bool aroundIsOpen_ = false;
};

}  // namespace

std::vector<Sides> visibleSides(const LitScene& scene, const PhotonMap& photons,
                                std::vector<NeededSides>* clearlyVisible) {
    const Walks walks(scene);
    const std::vector<uint32_t> ended = walks.ofSides();
    const auto statesBy = [&](const LitLimits& limits, uint32_t minWalks) {
        std::vector<SideState> states = litStates(scene, walks.components(), photons, limits);
        for (size_t s = 0; s < states.size(); ++s)
            if (ended[s] >= minWalks) states[s] = SideState::reached;
        return states;
    };
    if (clearlyVisible) *clearlyVisible = neededSides(statesBy(kClearlyLit, kClearlyVisible));
    return reachedSides(statesBy(kLit, kVisible));
}

}  // namespace phat
