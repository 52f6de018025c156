#pragma once
// Surfaces that others are seen through: blended ones and glass, drawn over the opaque ones.

#include "gl/fullscreen.h"
#include "gl/reflection_pass.h"
#include "gl/surface_drawing.h"

namespace phat {

/// Of the frame's size; empty where nothing needs them.
struct GlassTargets {
    GlTexture depth;          // of the nearest surface, opaque or glass
    ReflectionTargets panes;  // the nearest glass; empty when the CPU traces nothing
    GlTexture paneLight;      // what rays brought to it, see display.frag
    GlTexture behind;         // of behind.frag, with its smaller levels
    GlFramebuffer behindTarget;
};

/// What glass needs for a frame.
struct GlassNeeds {
    bool panes = false;   // its reflections are traced
    bool byCpu = false;   // and by the CPU
    bool behind = false;  // some is rough
};
GlassNeeds glassNeeds(const DrawnMaterials& materials, bool tracedByCpu, bool tracedByGpu);
/// Creates what is missing.
void completeGlassTargets(GlassTargets& targets, glm::uvec2 size, const GlassNeeds& needs, bool clearcoat);

struct GlassPass {
    ShaderProgram display;  // empty without glass
    FullscreenProgram behind;
    bool textures = false;  // whether the GPU has units for what glass has beyond opaque surfaces
};
/// `defines`: those of all display programs.
GlassPass createGlassPass(const std::string& shaderFolder, std::vector<std::string> defines, bool textures);

/// A picture that has its opaque surfaces.
struct OpaquePicture {
    glm::uvec2 size{0};
    const GlTexture& picture;
    const GlTexture& depth;
    const GlFramebuffer& target;
};

/// Draws the nearest glass before the opaque surfaces, to the bound target, whose depth is `targets.depth`.
void drawPanes(const ShaderProgram& program, const DisplayInput& input, const OpaquePicture& opaque,
               const GlassTargets& targets);
/// The same, and reads what the CPU is to trace of it: `sample.panes`.
void findPanes(const DisplayInput& input, const CameraMatrices& matrices, const OpaquePicture& opaque,
               const GlassTargets& targets, PendingSample& sample);
/// Makes what rays brought to sample.panes readable for drawBlended.
void uploadPanes(const DisplayInput& input, const GlassTargets& targets, const PendingSample& sample,
                 const TracedIncident& incident);

/// Programs and pictures of drawBlended.
struct BlendedDrawing {
    const ShaderProgram& blended;
    const GlassPass& glass;
    const GlassTargets& targets;
    bool tracedByGpu = false;  // whether rays have brought GlassTargets::paneLight
};
/// Blended surfaces and glass over what was drawn already: back to front; a surface's own back before its
/// front. Glass multiplies what is behind it by its transmittance in colour; rough glass blurs it, too. Of a
/// volume only the front is drawn, with the light of both of its sides.
void drawBlended(const BlendedDrawing& drawing, const DisplayInput& input, const CameraMatrices& matrices,
                 const OpaquePicture& opaque, const PendingSample& sample);

}  // namespace phat
