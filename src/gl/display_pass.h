#pragma once
// Pass 3: the picture.

#include <vector>

#include "gl/camera_matrices.h"
#include "gl/fullscreen.h"
#include "gl/glass_pass.h"
#include "gl/picture_sum.h"
#include "gl/surface_drawing.h"

namespace phat {

/// Colour and depth of one sample.
struct FrameTargets {
    glm::uvec2 size{0};
    GlTexture picture, depth;
    GlFramebuffer pictureTarget;
    LookupTargets lookup;           // empty when nothing is looked up
    ReflectionTargets reflections;  // empty when the CPU traces nothing
    RayTargets rays;                // empty when the GPU traces nothing
    GlassTargets glass;
};
/// `lookup` null: nothing is looked up, nor traced. `traced`: by the CPU; `rays` null: nothing by the GPU.
FrameTargets createFrameTargets(glm::uvec2 size, const LookupPass* lookup, bool traced, const RayPass* rays);

struct DisplayPass {
    ShaderProgram displayProgram, lookedUpProgram;
    GlassPass glass;
};

/// Small programs that every picture is drawn with, and that of the preview.
struct CommonPass {
    ShadowPrograms shadows;
    FullscreenProgram background, accumulate;
    ShaderProgram preview;
};
/// `glass`: whether there is any.
CommonPass createCommonPass(const std::string& shaderFolder, const GpuAtlas& atlas, bool glass);

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
/// Whether the driver has compiled it.
bool isReady(const DisplayPass& pass);

/// Draws the inputs of the display pass, from the background to the lookup, and the surfaces and
/// panes of `sample`. pre: the rest of it is set.
void prepareSample(const CommonPass& pass, const DisplayInput& input, const FrameTargets& targets,
                   PendingSample& sample);
/// The display pass, or the preview. Blended surfaces and glass take their glossy light from the pyramid with
/// either method, for a pixel of the lookup holds one surface; the nearest glass takes it from rays where
/// there are any.
void displaySample(const CommonPass& pass, const DisplayInput& input, const FrameTargets& targets,
                   const PendingSample& sample, const TracedIncident& incident);
/// Adds the picture that was displayed; the first one clears `sum`.
void addSample(const CommonPass& pass, const FrameTargets& targets, PictureSum& sum);

}  // namespace phat
