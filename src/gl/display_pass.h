#pragma once
// Pass 3: the picture.

#include <vector>

#include "gl/lookup_pass.h"
#include "gl/picture_sum.h"
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
    LookupTargets lookup;  // empty when nothing is looked up
};
/// `lookup` null: nothing is looked up.
FrameTargets createFrameTargets(glm::uvec2 size, const LookupPass* lookup);

struct DisplayPass {
    ShaderProgram displayProgram, lookedUpProgram, depthProgram, backgroundProgram, accumulateProgram;
    GlVertexArray noVertices;
    std::vector<uint32_t> blendOrder;  // reused from frame to frame
};

DisplayPass createDisplayPass(const std::string& shaderFolder, const GpuAtlas& atlas, bool clearcoat);

struct DisplayInput {
    const GpuScene& scene;
    const GpuAtlas& atlas;
    const RelightPass& relit;
    const ShadowMaps& shadows;
    const GpuLookup& lookup;
    const LookupPass& lookupPass;
    const std::vector<Material>& materials;
};

/// Adds the next jittered pictures of `settings.samplesPerPixel` to `sum`. Blended surfaces take their glossy
/// light from the pyramid with either method, for a pixel of the lookup holds one surface.
void display(DisplayPass& pass, const DisplayInput& input, const FrameSettings& settings,
             const FrameTargets& targets, PictureSum& sum);

/// The eye of a camera.
Eye eyeOf(const Camera& camera);

}  // namespace phat
