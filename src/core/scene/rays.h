#pragma once
// Ray queries against a scene: a small door to Embree. Nothing else includes it.

#include <cstdint>
#include <memory>

#include "core/scene/scene.h"
#include "core/scene/transparency.h"

namespace phat {

inline constexpr uint32_t kNoTriangle = ~0u;

struct Hit {
    float distance = 0;               // metres along the unit direction
    uint32_t triangle = kNoTriangle;  // index into Scene::triangles
    glm::vec2 barycentric{0};         // weights of the triangle's second and third vertex
    bool backFace = false;            // the ray came from behind the (counter-clockwise) front

    explicit operator bool() const { return triangle != kNoTriangle; }
};

struct Ray {
    glm::vec3 origin{0};
    glm::vec3 direction{0};  // unit
};

/// Embree scene over all triangles, robust mode. Alpha-masked texels are passed through; blended ones are
/// passed with probability 1 - alpha, decided by a hash of the ray, so that equal rays have equal hits. Glass
/// is hit like any other surface: see core/scene/glass.h.
/// Safe to share between threads; copies share the acceleration structure. `scene` must outlive them.
class RayScene {
  public:
    /// Embree's acceleration structure. It has a copy of the triangles and keeps nothing else of the scene.
    struct Bvh;
    static std::shared_ptr<const Bvh> buildBvh(const Scene& scene);

    explicit RayScene(const Scene& scene) : RayScene(scene, buildBvh(scene)) {}
    /// pre: `bvh` was built of a scene with the same triangles at the same positions, and hasTransparency()
    /// was the same.
    RayScene(const Scene& scene, std::shared_ptr<const Bvh> bvh)
        : scene_(&scene), bvh_(std::move(bvh)), glass_(glassOfSurfaces(scene, scene.materials)) {}

    const Scene& scene() const { return *scene_; }
    const std::shared_ptr<const Bvh>& bvh() const { return bvh_; }

    /// lengthUnit() of the scene.
    float unitMeters() const;

    /// Whether glassOf() is anything but `none` anywhere.
    bool hasGlass() const { return !glass_.empty(); }
    Glass glassOf(uint32_t triangle) const {
        return glass_.empty() ? Glass::none : glass_[scene_->triangleSurface[triangle]];
    }

    /// Nearest hit with 0 < distance < maxDistance. pre: |direction| = 1.
    Hit closestHit(glm::vec3 origin, glm::vec3 direction, float maxDistance = 1e30f) const;

    /// Whether anything lies on the open segment. pre: |direction| = 1.
    bool anyHit(glm::vec3 origin, glm::vec3 direction, float maxDistance) const;

    /// All triangles whose bounds come within `radius` of a point, ascending, and some that do not.
    std::vector<uint32_t> trianglesNear(glm::vec3 point, float radius) const;

    /// A position on a surface moved off it: the function of this name, by the scene's unit.
    glm::vec3 offsetOrigin(glm::vec3 position, glm::vec3 normal) const;

  private:
    const Scene* scene_;
    std::shared_ptr<const Bvh> bvh_;
    std::vector<Glass> glass_;  // [surface]; empty where there is none
};

/// `position` moved off its surface, far enough that rays on the side of `normal` do not meet the triangle
/// again and no farther than float rounding asks. `unitMeters`: lengthUnit() of the scene, by which
/// coordinates near zero are judged. pre: |normal| = 1, on the side that the ray leaves. source: Waechter and
/// Binder 2019, "A Fast and Robust Method for Avoiding Self-Intersection".
glm::vec3 offsetOrigin(glm::vec3 position, glm::vec3 normal, float unitMeters);

}  // namespace phat
