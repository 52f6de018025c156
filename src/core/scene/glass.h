#pragma once
// Rays through transmissive surfaces: KHR_materials_transmission, KHR_materials_volume, KHR_materials_ior.
//
// Radiance is carried divided by the square of the index of refraction, so that neither entering a volume nor
// leaving it scales it (the basic radiance of Nicodemus 1963).

#include "core/base/random.h"
#include "core/scene/rays.h"
#include "core/scene/shading.h"

namespace phat {

/// A ray on its way through glass. At each interface it is transmitted with a probability equal to the
/// transmittance, or stays there.
class GlassWalk {
  public:
    /// The random choices follow from `seed` and the ray: equal rays make equal choices.
    GlassWalk(const RayScene& rays, const Ray& ray, uint64_t seed);

    /// Whether the ray goes on, as ray(), from a hit of ray() on glass. Where it does not, what the surface
    /// reflects and emits toward where the ray came from counts by throughput(). Internal reflections are a
    /// way of going on.
    bool passes(const Hit& hit);
    /// To be called with the hit of ray() at which the way ends, if it is not glass: absorbs light along it.
    void ends(const Hit& hit) { absorb(hit); }

    const Ray& ray() const { return ray_; }
    glm::vec3 throughput() const { return throughput_; }
    /// Metres to where ray() begins.
    float wayMeters() const { return way_; }
    bool inside() const { return inside_ != nullptr; }

  private:
    void absorb(const Hit& hit);
    void goOn(const SurfacePoint& from, glm::vec3 direction);
    glm::vec3 transmitted(const SurfacePoint& at, const Material& material, Glass glass);
    bool leaves(const SurfacePoint& at, const Material& material);

    const RayScene& rays_;
    Ray ray_;
    glm::vec3 from_;  // the surface that ray_ leaves; a slab may be as thin as its offset from it is long
    Rng rng_;
    glm::vec3 throughput_{1};
    float way_ = 0;
    const Material* inside_ = nullptr;  // of the volume that the ray is in
    int crossings_ = 0;
};

/// What a ray meets behind, or in, glass.
struct SeenThrough {
    Hit hit;  // its distance is along the whole way
    Ray ray;  // that hit it
    glm::vec3 throughput{1};
};

/// Whose sides a ray meets.
enum class SeenSides : uint8_t {
    both,
    visible,  // rays from a camera pass the backs of single-sided surfaces
};

/// The surface at which a ray's way through glass ends; a glass that it is not transmitted by may be one.
/// `rayCount` grows by the rays beyond the first. Without glass: the closest hit.
SeenThrough seeThrough(const RayScene& rays, const Ray& ray, uint64_t seed, uint64_t& rayCount,
                       SeenSides sides = SeenSides::both);

/// What lies straight ahead, behind all glass.
struct StraightView {
    Hit hit;                     // on an opaque surface; its distance is from the origin
    glm::vec3 transmittance{1};  // 0 behind glass that lets nothing through
};

/// For shadow rays: not bent by refraction and not scattered by roughness, which is exact for panes and for
/// volumes between parallel planes, internal reflections included, but for the small shift of the ray; for
/// other volumes it is an approximation: they cast shadows of their transmittance and no caustics.
StraightView seeStraight(const RayScene& rays, const Ray& ray, float maxDistance, uint64_t& rayCount);

}  // namespace phat
