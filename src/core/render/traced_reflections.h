#pragma once
// What lobes see by rays that end in what is baked, where PHATexels lie too far apart to show it as sharp.
// source: Hensley et al. 2003, section 8, names rays for smooth surfaces; which lobes, and how, is ours
// (docs/lookup.md).

#include <span>
#include <vector>

#include "core/bake/irradiance_ray.h"
#include "core/render/picture.h"
#include "core/scene/light_bound.h"

namespace phat {

/// Which lobes rays answer.
enum class Reflections : uint8_t {
    automatic,  // those too sharp for the PHATexels around, in part those that nearly are
    rays,       // all
    lookup,     // none
};

/// A GGX lobe in scalars: its colour is the caller's.
struct TracedLobe {
    glm::vec3 normal{0, 0, 1};  // world, not facing away from the eye
    float alpha = 0;            // 0: no lobe
    float f0 = 1;
    float f90 = 1;
    float share = 0;     // how far rays take the place of the lookup, 0 to 1
    float distance = 1;  // metres to the nearest that it sees, roughly
};

/// The opaque surface that a pixel shows.
struct TracedSurface {
    uint32_t pixel = 0;  // its number, row by row: seeds the random numbers
    glm::vec2 place{0};  // in the picture, as cameraRay takes it
    uint32_t triangle = kNoTriangle;
    bool back = false;
    TracedLobe base, coat;
};

/// The mean radiance that a lobe sees, weighted by the lobe: times its directional albedo it is what it
/// reflects.
struct SeenByLobe {
    glm::vec3 indirect{0};  // light that was reflected before
    glm::vec3 area{0};      // straight from emissive surfaces and the environment
    float share = 0;        // TracedLobe's; 0 also where no ray left the surface
};
struct SeenBySurface {
    SeenByLobe base, coat;
};

/// What the rays read; all of it must outlive it. The materials may change, the bake does not follow.
struct ReflectionScene {
    ReflectionScene(const RayScene& rayScene, const LightSampler& lightSampler, const Atlas& bakedAtlas,
                    const TexelPoints& points, const Phatexture& baked)
        : rays(rayScene),
          lights(lightSampler),
          atlas(bakedAtlas),
          phatexture(baked),
          texels(irradianceTexels(bakedAtlas, points)),
          brightest(brightestRadiance(rayScene.scene())) {}

    const RayScene& rays;
    const LightSampler& lights;
    const Atlas& atlas;
    const Phatexture& phatexture;
    std::vector<uint8_t> texels;
    glm::vec3 brightest;
};

struct ReflectionView {
    Camera camera;
    int width = 0, height = 0;  // pixels
    uint32_t frame = 0;         // of several pictures whose mean is shown: each continues the sequence
    int pictures = 1;           // how many they will be: rays are shared out
    bool indirect = true;       // which parts are wanted
    bool area = true;
};

/// [surface]. Lobes whose share is 0 are left out. The same values for any number of threads. Adds the rays
/// it traced to `rayCount`. Throws Interrupted when `progress` asks.
std::vector<SeenBySurface> traceReflections(const ReflectionScene& scene, const ReflectionView& view,
                                            std::span<const TracedSurface> surfaces, Progress& progress,
                                            uint64_t& rayCount);

}  // namespace phat
