#pragma once
// Things that were not in the bake, drawn among what was: lit by probes and by punctual lights.

#include "gl/probe_upload.h"
#include "gl/surface_drawing.h"

namespace phat {

/// Things on the GPU, and the probes around them.
struct GpuAdded {
    GpuScene scene;
    std::vector<Material> materials;
    std::vector<Glass> glass;  // none: theirs is drawn opaque
    GpuProbes probes;
    std::vector<glm::vec4> occluders;  // rowsOf() them

    DrawnMaterials drawn() const { return {materials, glass}; }
};

/// Throws GlError.
GpuAdded uploadAdded(const AddedThings& added);

/// The program of all of their surfaces. `discs`, `glass`: as of DisplayFeatures.
ShaderProgram createAddedProgram(const std::string& shaderFolder, bool discs, bool glass);

/// Opaque things, where their depth is in the target already. pre: input.added.
void drawAddedOpaque(const DisplayInput& input, const CameraMatrices& matrices,
                     const FrameSettings& settings);
/// Blended ones, far to near, over what was drawn. pre: the same.
void drawAddedBlended(const DisplayInput& input, const CameraMatrices& matrices,
                      const FrameSettings& settings);

}  // namespace phat
