#pragma once
// Pass 3: the picture.

#include <vector>

#include "gl/fullscreen.h"
#include "gl/lookup_pass.h"
#include "gl/pass_clock.h"
#include "gl/picture_sum.h"
#include "gl/reflection_pass.h"
#include "gl/relight_pass.h"
#include "gl/renderer.h"
#include "gl/scene_upload.h"
#include "gl/shadow_maps.h"

namespace phat {

/// Colour and depth of one sample.
struct FrameTargets {
    glm::uvec2 size{0};
    GlTexture picture, depth;
    GlFramebuffer pictureTarget;
    LookupTargets lookup;           // empty when nothing is looked up
    ReflectionTargets reflections;  // empty when nothing is traced
};
/// `lookup` null: nothing is looked up, nor traced.
FrameTargets createFrameTargets(glm::uvec2 size, const LookupPass* lookup, bool traced);

struct DisplayPass {
    ShaderProgram displayProgram, lookedUpProgram, depthProgram;
    FullscreenProgram background, accumulate;
};

/// `paper`: as of the RelightPass whose pyramid is displayed; `countReads`: see createLookupPass.
DisplayPass createDisplayPass(const std::string& shaderFolder, const GpuAtlas& atlas, bool clearcoat,
                              bool paper, bool countReads);

struct DisplayInput {
    const GpuScene& scene;
    const GpuAtlas& atlas;
    const ShadowMaps& shadows;
    const GpuLookup& lookup;
    const std::vector<Material>& materials;
    // Null where the picture does not need them.
    const RelightPass* relit;
    const LookupPass* lookupPass;
    const ReflectionPass* reflectionPass;
    const ShaderProgram* inspectProgram;  // inspect.frag, to be shown in place of light
    PassClock& clock;
    float environmentTurn = 0;  // see background.frag
};

/// What rays cost a frame.
struct ReflectionCost {
    double seconds = 0;
    uint64_t rays = 0;
};

/// Adds the next jittered pictures of `settings.samplesPerPixel` to `sum`. Blended surfaces take their glossy
/// light from the pyramid with either method, for a pixel of the lookup holds one surface.
ReflectionCost display(const DisplayPass& pass, const DisplayInput& input, const FrameSettings& settings,
                       const FrameTargets& targets, PictureSum& sum);

/// The eye of a camera.
Eye eyeOf(const Camera& camera);

}  // namespace phat
