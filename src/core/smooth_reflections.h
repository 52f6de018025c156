#pragma once
// What smooth lobes see, by rays that end in what is baked: reflections sharper than PHATexels lie close.
// source: Hensley et al. 2003, section 8, names rays for them; how is ours (docs/pipeline.md, section 10).

#include <span>
#include <vector>

#include "core/irradiance_ray.h"
#include "core/light_bound.h"
#include "core/picture.h"

namespace phat {

/// Which lobes rays answer.
enum class Reflections : uint8_t {
    automatic,  // those too sharp for PHATexels, in part those that nearly are
    rays,       // all
    lookup,     // none
};

/// How far rays take the place of the lookup for a lobe, 0 to 1; 0 for alpha 0, "no lobe".
float tracedShare(Reflections reflections, float alpha);

/// Whether any of the materials may have a lobe that rays answer, whatever its textures say.
bool mayReflectSmoothly(std::span<const Material> materials, Reflections reflections);

/// A GGX lobe in scalars: its colour is the caller's.
struct SmoothLobe {
    glm::vec3 normal{0, 0, 1};  // world, not facing away from the eye
    float alpha = 0;            // 0: no lobe
    float f0 = 1;
    float f90 = 1;
};

/// The opaque surface that a pixel shows.
struct SmoothSurface {
    uint32_t pixel = 0;  // the caller's number of it: seeds the random numbers
    glm::vec2 place{0};  // in the picture, as cameraRay takes it
    uint32_t triangle = kNoTriangle;
    bool back = false;
    SmoothLobe base, coat;
};

/// The mean radiance that a lobe sees, weighted by the lobe: times its directional albedo it is what it
/// reflects.
struct SeenByLobe {
    glm::vec3 indirect{0};  // light that was reflected before
    glm::vec3 area{0};      // straight from emissive surfaces and the environment
    float share = 0;        // tracedShare; 0 also where no ray left the surface
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
    bool indirect = true;       // which parts are wanted
    bool area = true;
};

/// [surface]. The same values for any number of threads. Adds the rays it traced to `rayCount`. Throws
/// Interrupted when `progress` asks. pre: reflections != lookup.
std::vector<SeenBySurface> traceReflections(const ReflectionScene& scene, const ReflectionView& view,
                                            Reflections reflections, std::span<const SmoothSurface> surfaces,
                                            Progress& progress, uint64_t& rayCount);

}  // namespace phat
