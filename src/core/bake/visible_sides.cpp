#include "core/bake/visible_sides.h"

#include <tbb/parallel_for.h>

#include <algorithm>

#include "core/scene/enclosure.h"
#include "core/scene/glass.h"
#include "core/scene/triangle_corners.h"

namespace phat {
namespace {

// Rays from an eye, and how many of them have to meet a side: a 64th of the view. What is smaller is seen
// from the sides around; what is seen through a crack is no such part.
constexpr uint32_t kEyeRays = 512, kMinEyeRays = 8;
// An eye of whose rays more than this part meet nothing is outside.
constexpr float kOutside = 0.5f;
// What a ray passes, at most, of what moves.
constexpr int kMaxPassed = 16;

// Surfaces that are closer, in lengths of the scene's unit, lie in one place: a thing that stands on a floor.
constexpr float kSamePlace = 1e-4f;

constexpr uint32_t kRests = ~0u;

/// Where eyes and lights may be.
std::vector<glm::vec3> eyesOf(const RayScene& rays, const std::vector<StandPoint>& stands) {
    const Scene& scene = rays.scene();
    std::vector<glm::vec3> eyes;
    for (const StandPoint& stand : stands) eyes.push_back(stand.eye);
    for (const Camera& camera : scene.cameras) eyes.push_back(glm::vec3(camera.worldFromCamera[3]));
    for (const PunctualLight& light : scene.lights)
        if (light.type != PunctualLight::Type::directional) eyes.push_back(light.position);
    return eyes;
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

/// Unit; of a triangle without an area not a number.
glm::vec3 faceNormal(const Scene& scene, uint32_t triangle) {
    const auto [a, b, c] = cornersOf(scene, triangle);
    return glm::normalize(glm::cross(b - a, c - a));
}

/// Whether a triangle lies where another one is hit, in its plane.
bool liesAt(const Scene& scene, uint32_t triangle, glm::vec3 at, glm::vec3 hitNormal, float within) {
    const auto [a, b, c] = cornersOf(scene, triangle);
    const float twiceArea = glm::length(glm::cross(b - a, c - a));
    if (!(twiceArea > 0)) return false;
    const glm::vec3 normal = faceNormal(scene, triangle);
    constexpr float kParallel = 0.999f, kEdge = 1e-3f;
    if (std::abs(glm::dot(normal, hitNormal)) < kParallel) return false;
    if (std::abs(glm::dot(normal, at - a)) > within) return false;
    const float u = glm::dot(glm::cross(at - a, c - a), normal) / twiceArea;
    const float v = glm::dot(glm::cross(b - a, at - a), normal) / twiceArea;
    return u > -kEdge && v > -kEdge && u + v < 1 + kEdge;
}

class Sight {
  public:
    explicit Sight(const LitScene& lit)
        : lit_(lit), components_(findComponents(lit.rays.scene())), movers_(moversOf(lit.rays.scene())) {
        anythingMoves_ = std::any_of(movers_.begin(), movers_.end(), [](uint32_t m) { return m != kRests; });
        findEyes();
    }
    const Components& components() const { return components_; }

    /// Spreads from the sides that are reached, and from eyes.
    std::vector<SideState> spread(std::vector<SideState> states, uint32_t minSeen) const {
        const Scene& scene = lit_.rays.scene();
        for (uint32_t s = 0; s < states.size(); ++s) {
            if (states[s] == SideState::reached || !isSide(scene, components_, s)) continue;
            states[s] = seenFromEyes_[s] ? SideState::reached : SideState::undecided;
        }
        std::vector<std::vector<uint32_t>> meets(states.size());
        tbb::parallel_for(uint32_t(0), uint32_t(states.size()), [&](uint32_t s) {
            if (states[s] == SideState::undecided) meets[s] = meetsOf(s, states);
        });
        spreadBySight(states, meets, minSeen);
        return states;
    }

  private:
    using States = std::vector<SideState>;

    // Of surfaces in one place a ray meets any. Inside a solid that stands on a floor it may be the floor,
    // which is reached: then the other one counts.
    uint32_t darkerInPlace(const Ray& ray, const Hit& hit, const States& states) const {
        const Scene& scene = lit_.rays.scene();
        const uint32_t side = components_.sideOf(hit);
        if (states[side] != SideState::reached) return side;
        const glm::vec3 at = ray.origin + hit.distance * ray.direction;
        const float within = kSamePlace * lit_.rays.unitMeters();
        const glm::vec3 normal = faceNormal(scene, hit.triangle);
        for (const uint32_t triangle : lit_.rays.trianglesNear(at, within)) {
            if (triangle == hit.triangle || !liesAt(scene, triangle, at, normal, within)) continue;
            const bool fromBehind = glm::dot(faceNormal(scene, triangle), ray.direction) > 0;
            const uint32_t other = 2 * components_.ofTriangle[triangle] + fromBehind;
            if (isSide(scene, components_, other) && states[other] != SideState::reached) return other;
        }
        return side;
    }

    uint32_t metBy(const Ray& ray, const Hit& hit, const States& states) const {
        if (hit) return darkerInPlace(ray, hit, states);
        const bool light = aroundIsOpen_ || maxComponent(lit_.lights.environmentRadiance(ray.direction)) > 0;
        return light ? kMeetsLight : kMeetsNothing;
    }

    uint32_t straight(const Ray& ray, const States& states) const {
        uint64_t rayCount = 0;
        return metBy(ray, seeStraight(lit_.rays, ray, kFarDistance, rayCount).hit, states);
    }

    // What a ray from a surface of `mover` meets if all else that moves is away.
    uint32_t pastMoving(Ray ray, uint32_t mover, const States& states) const {
        const Scene& scene = lit_.rays.scene();
        Hit hit;
        for (int passed = 0; passed < kMaxPassed; ++passed) {
            uint64_t rayCount = 0;
            hit = seeStraight(lit_.rays, ray, kFarDistance, rayCount).hit;
            if (!hit) break;
            const uint32_t met = movers_[scene.triangleSurface[hit.triangle]];
            if (met == kRests || met == mover) break;
            const glm::vec3 at = ray.origin + hit.distance * ray.direction;
            ray.origin = lit_.rays.offsetOrigin(at, ray.direction);
        }
        return metBy(ray, hit, states);
    }

    std::vector<uint32_t> meetsOf(uint32_t side, const States& states) const {
        std::vector<uint32_t> meets = meetsFromSide(lit_.rays, components_, side,
                                                    [&](const Ray& ray) { return straight(ray, states); });
        if (!anythingMoves_) return meets;
        const uint32_t triangle = components_.triangle[components_.first[side / 2]];
        const uint32_t mover = movers_[lit_.rays.scene().triangleSurface[triangle]];
        const std::vector<uint32_t> past = meetsFromSide(
            lit_.rays, components_, side, [&](const Ray& ray) { return pastMoving(ray, mover, states); });
        meets.insert(meets.end(), past.begin(), past.end());
        return meets;
    }

    void findEyes() {
        const std::vector<StandPoint> stands = standPointsOfAllStoreys(lit_.rays);
        const auto& lights = lit_.rays.scene().lights;
        aroundIsOpen_ = stands.empty() || std::any_of(lights.begin(), lights.end(), [](const auto& light) {
                            return light.type == PunctualLight::Type::directional;
                        });
        seenFromEyes_.assign(2 * size_t(components_.count()), 0);
        for (const glm::vec3& eye : eyesOf(lit_.rays, stands)) {
            std::vector<uint32_t> met(kEyeRays);
            tbb::parallel_for(uint32_t(0), kEyeRays, [&](uint32_t i) {
                uint64_t rayCount = 0;
                const Ray ray{eye, spherePoint(int(i), int(kEyeRays))};
                const Hit hit = seeStraight(lit_.rays, ray, kFarDistance, rayCount).hit;
                met[i] = hit ? components_.sideOf(hit) : kMeetsNothing;
            });
            std::sort(met.begin(), met.end());
            for (auto from = met.begin(); from != met.end();) {
                const auto to = std::upper_bound(from, met.end(), *from);
                if (*from == kMeetsNothing)
                    aroundIsOpen_ = aroundIsOpen_ || float(to - from) > kOutside * kEyeRays;
                else if (to - from >= kMinEyeRays)
                    seenFromEyes_[*from] = 1;
                from = to;
            }
        }
    }

    LitScene lit_;
    Components components_;
    std::vector<uint32_t> movers_;  // [surface]
    bool anythingMoves_ = false;
    bool aroundIsOpen_ = false;
    std::vector<uint8_t> seenFromEyes_;  // [side]
};

}  // namespace

std::vector<Sides> visibleSides(const LitScene& scene, const PhotonMap& photons,
                                std::vector<NeededSides>* clearlyVisible) {
    const Sight sight(scene);
    const auto statesBy = [&](const LitLimits& limits) {
        return sight.spread(litStates(scene, sight.components(), photons, limits), limits.seen);
    };
    if (clearlyVisible) *clearlyVisible = neededSides(statesBy(kClearlyLit));
    return reachedSides(statesBy(kLit));
}

}  // namespace phat
