#pragma once
// Lobes that the GPU traces: lobes.frag says which, then for each lobe reflection_guides.frag how many rays,
// trace_reflections.frag, shade_reflections.frag and trace_lights.frag once a ray, mean_reflections.frag and
// pool_reflections.frag. Small programs, one after the other, because drivers take long to compile large
// ones.

#include "core/bvh/scene_bvh.h"
#include "gl/bvh_upload.h"
#include "gl/hit_tables.h"
#include "gl/lookup_pass.h"
#include "gl/pass_clock.h"
#include "gl/ray_counter.h"
#include "gl/relight_pass.h"
#include "gl/renderer.h"
#include "gl/shadow_maps.h"

namespace phat {

/// What the rays read.
struct GpuRayScene {
    GpuBvh bvh;
    GpuHits hits;
    glm::vec3 brightest{0};  // brightestRadiance() of the scene
};

/// What the programs of a RayPass can do.
struct RayFeatures {
    std::vector<std::string> bvhDefines;  // of the trees
    bool glass = false;                   // whether there is any
    bool sky = false;                     // whether there is an environment
    bool counts = false;                  // with shaders/lib/count_fetches.glsl
};

struct RayPass {
    ShaderProgram lobes;
    FullscreenProgram guides, trace, shade, lights, mean, pool, reproject;
    FullscreenProgram skyLights;  // empty without a sky
    bool clearcoat = false;
    bool glass = false;
    bool sky = false;
};

/// Throws GlError.
RayPass createRayPass(const std::string& shaderFolder, const LookupPass& lookup, const GpuLookup& tables,
                      const RayFeatures& features);
bool isReady(const RayPass& pass);

/// Pictures between the passes, of the frame's size.
struct RayTargets {
    /// What the next frame needs of a lobe.
    struct Frame {
        GlTexture guides;                    // RGBA32UI, see lib/reflection_guides.glsl
        GlTexture light;                     // RGBA32UI, see lib/pooled_light.glsl
        GlFramebuffer guidesTarget, target;  // the latter: layers of LookupTargets::incident, and `light`
    };
    GlTexture points;                  // RGBA32UI, see lobes.frag
    GlTexture hits, places;            // RGBA32UI, see lib/packed_rays.glsl
    GlTexture indirectSums, areaSums;  // RGBA16F, see shade_reflections.frag
    GlTexture means, pooled;           // RGBA32UI, see lib/pooled_light.glsl
    GlTexture counts;                  // DEPTH_COMPONENT16: see reflection_guides.frag
    GlFramebuffer lobesTarget, raysTarget, sumsTarget, areaTarget, meansTarget, pooledTarget;
    std::array<std::vector<Frame>, 2> frames;  // [frame % 2][lobe]
    // Of the nearest glass, which is traced after the opaque surfaces; empty where there is none.
    GlFramebuffer paneLobesTarget;
    std::vector<Frame> panes;  // [lobe]
};
/// `lookup`: with layers for traced radiance.
RayTargets createRayTargets(const LookupPass& pass, const LookupTargets& lookup, GLuint depth);
/// Adds those of the nearest glass, whose depth is `depth`, to `targets`; `light` has two layers a lobe.
void addPaneTargets(RayTargets& targets, const LookupTargets& lookup, GLuint depth, const GlTexture& light);

/// What the rays meet, as it is now.
struct LitWorld {
    const GpuRayScene& rays;
    const GpuAtlas& atlas;
    const GpuLookup& lookup;
    const GpuScene& surfaces;
    const ShadowMaps& shadows;
    float environmentTurn = 0;
};

/// Binds what shade_reflections.frag reads of the world and of the rays, see shaders/lib/packed_rays.glsl.
void bindHitShading(const ShaderProgram& program, const LitWorld& world, const GlTexture& hits,
                    const GlTexture& places);

/// The camera of the last frame.
struct RayHistory {
    glm::mat4 clipFromWorld{1};
    Eye eye;
    uint32_t frames = 0;  // that were drawn
    bool valid = false;   // whether they tell anything of the next
};

/// A frame for which rays are traced.
struct RayFrame {
    const GpuRayScene& scene;
    const GpuAtlas& atlas;
    const GpuLookup& lookup;
    const GpuScene& surfaces;
    const ShadowMaps& shadows;
    const LookupTargets& lookupTargets;
    glm::mat4 clipFromWorld{1};
    Eye eye;
    float pixelRadians = 0;  // angle of a pixel
    float environmentTurn = 0;
    uint32_t seed = 0;
    RayBudget budget;
    RayHistory& history;
    RayCounter& counter;
    PassClock& clock;
    bool follows = false;  // whether the last frame's rays count
    bool ofPanes = false;  // whether the surfaces are the nearest glass
};

/// Clears the lookup's sums and binds the cleared targets of the lobes; the caller draws its opaque surfaces,
/// or the nearest glass, with RayPass::lobes.
void beginTracedLobes(const RayPass& pass, const RayTargets& targets, const RayFrame& frame);
/// Then: writes to the layers of LookupTargets::incident that follow the lookup's own, and makes the frame
/// the last one; or to the light of addPaneTargets().
void traceLobes(const RayPass& pass, const RayTargets& targets, const RayFrame& frame);

}  // namespace phat
