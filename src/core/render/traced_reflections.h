#pragma once
// Incident light of lobes by reflection rays whose hits are shaded from the bake, where the PHATexels'
// spacing cannot resolve the lobe.
// source: Hensley et al. 2003, section 8, names rays for smooth surfaces; which lobes, and how, is ours
// (docs/lookup.md).

#include <span>
#include <vector>

#include "core/bake/irradiance_ray.h"
#include "core/render/picture.h"
#include "core/scene/footprint.h"
#include "core/scene/light_bound.h"

namespace phat {

/// Which lobes are traced.
enum class Reflections : uint8_t {
    automatic,  // those too sharp for the local PHATexels, blended where they nearly are
    rays,       // all
    lookup,     // none
};

/// A GGX lobe in scalars: its colour is the caller's.
struct TracedLobe {
    glm::vec3 normal{0, 0, 1};  // world, not facing away from the eye
    float alpha = 0;            // 0: no lobe
    float f0 = 1;
    float f90 = 1;
    float weight = 0;    // of rays against the lookup, 0 to 1
    float distance = 1;  // metres, approximate, to the nearest surface under the lobe
};

/// The opaque surface that a pixel shows.
struct TracedSurface {
    uint32_t pixel = 0;     // its number, row by row: seeds the random numbers
    glm::vec2 position{0};  // in the image, pixels: see cameraRay
    uint32_t triangle = kNoTriangle;
    bool back = false;
    TracedLobe base, coat;
};

/// Mean incident radiance weighted by a lobe; times the lobe's directional albedo it is reflected radiance.
struct LobeIncident {
    glm::vec3 indirect{0};  // light that was reflected before
    glm::vec3 area{0};      // straight from emissive surfaces and the environment
    float weight = 0;       // TracedLobe's; 0 also where no ray left the surface
};
struct SurfaceIncident {
    LobeIncident base, coat;
};

/// Of the environment, what is darker than so many times its mean is left to the lobes' own rays, which find
/// it without noise: with light samples there, the rare rays of a sharp lobe that are far from its peak would
/// count for little, and a mirror of the sky have dark specks. Not tuned.
/// source: Karlik et al. 2019, "MIS Compensation". twin: web/src/environment_upload.js.
inline constexpr float kMinOverMean = 2;

/// What the rays read; all of it must outlive this object. A change of materials does not change the bake.
struct ReflectionScene {
    ReflectionScene(const RayScene& rayScene, const LightSampler& lightSampler, const Atlas& bakedAtlas,
                    const TexelPoints& texelPoints, const Phatexture& baked)
        : rays(rayScene),
          lights(lightSampler),
          atlas(bakedAtlas),
          points(texelPoints),
          phatexture(baked),
          texels(irradianceTexels(bakedAtlas, texelPoints)),
          brightest(brightestRadiance(rayScene.scene())),
          minSampledSky(kMinOverMean * float(meanEnvironmentLuminance(rayScene.scene()))),
          levels(rayScene.scene()) {}

    const RayScene& rays;
    const LightSampler& lights;
    const Atlas& atlas;
    const TexelPoints& points;
    const Phatexture& phatexture;
    std::vector<uint8_t> texels;
    glm::vec3 brightest;
    float minSampledSky;  // luminance from which the environment has light samples
    TextureLevels levels;
};

struct ReflectionView {
    Camera camera;
    int width = 0, height = 0;  // pixels
    uint32_t frame = 0;         // of several pictures whose mean is shown: each continues the sequence
    int pictures = 1;           // how many there will be: the ray budget is divided among them
    bool indirect = true;       // which parts are computed
    bool area = true;
    PixelFilter filter = PixelFilter::box;  // with `center` textures are not filtered, either
};

/// [surface]. Lobes of weight 0 are left out. The same values for any number of threads. Adds the rays
/// it traced to `rayCount`. Throws Interrupted when `progress` requests it.
std::vector<SurfaceIncident> traceReflections(const ReflectionScene& scene, const ReflectionView& view,
                                              std::span<const TracedSurface> surfaces, Progress& progress,
                                              uint64_t& rayCount);

}  // namespace phat
