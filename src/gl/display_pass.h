#pragma once
// Pass 3: the picture.

#include <vector>

#include "gl/camera_matrices.h"
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
    ShaderProgram displayProgram, lookedUpProgram, glassProgram;
    ShadowPrograms shadows;
    FullscreenProgram background, accumulate;
};

/// What the programs of a DisplayPass can do.
struct DisplayFeatures {
    bool clearcoat = false;
    bool glass = false;       // whether there is any
    bool discs = false;       // whether a light is one
    bool paper = false;       // as of the RelightPass whose pyramid is displayed
    bool countReads = false;  // see createLookupPass
};
DisplayPass createDisplayPass(const std::string& shaderFolder, const GpuAtlas& atlas,
                              const DisplayFeatures& features);

struct DisplayInput {
    const GpuScene& scene;
    const GpuAtlas& atlas;
    const ShadowMaps& shadows;
    const GpuLookup& lookup;
    const DrawnMaterials materials;
    // Null where the picture does not need them.
    const RelightPass* relit;
    const LookupPass* lookupPass;
    const ReflectionPass* reflectionPass;
    const ShaderProgram* inspectProgram;  // inspect.frag, drawn instead of the light
    PassClock& clock;
    float environmentTurn = 0;  // see background.frag
};

/// Draws the inputs of the display pass, from the background to the lookup, and `sample.surfaces`. pre:
/// the rest of `sample` is set.
void prepareSample(const DisplayPass& pass, const DisplayInput& input, const FrameTargets& targets,
                   PendingSample& sample);
/// The display pass. `incident`: traced radiance of `sample.surfaces`. Blended surfaces take their glossy
/// light from the pyramid with either method, for a pixel of the lookup holds one surface.
void displaySample(const DisplayPass& pass, const DisplayInput& input, const FrameTargets& targets,
                   const PendingSample& sample, std::span<const SurfaceIncident> incident);
/// Adds the picture that was displayed; the first one clears `sum`.
void addSample(const DisplayPass& pass, const FrameTargets& targets, PictureSum& sum);

/// Direct, glossy indirect and diffuse indirect light: 1 for those that are shown.
glm::vec3 shownParts(Component component);

}  // namespace phat
