#pragma once
// What the passes that draw the scene's surfaces have in common: the view, and a surface with its material.

#include "gl/camera_matrices.h"
#include "gl/lookup_pass.h"
#include "gl/material_table.h"
#include "gl/pass_clock.h"
#include "gl/ray_pass.h"
#include "gl/reflection_pass.h"
#include "gl/relight_pass.h"
#include "gl/renderer.h"
#include "gl/scene_upload.h"
#include "gl/shadow_maps.h"

namespace phat {

// Texture units 0-6 are common to all materials, 7-15 a material's nine slots: the 16 that every GPU has.
inline constexpr int kFirstMaterialUnit = 7;
// And more where there is glass: its own slots, the shadows that it casts, its traced reflections and what is
// behind it. Most GPUs have 32.
inline constexpr int kTintUnit = kFirstMaterialUnit + kSlotCount, kPanesUnit = kTintUnit + 1,
                     kPaneLightUnit = kTintUnit + 2, kBehindUnit = kTintUnit + 3, kGlassUnits = kTintUnit + 4;
// And one where a light is a disc.
inline constexpr int kDepthUnit = kGlassUnits;

struct DisplayPass;
struct GpuAdded;

/// What the passes of a frame read.
struct DisplayInput {
    const GpuScene& scene;
    const GpuAtlas& atlas;
    const ShadowMaps& shadows;
    const GpuLookup& lookup;
    const DrawnMaterials materials;
    // Null where the picture does not need them.
    const DisplayPass* display;
    const RelightPass* relit;
    const LookupPass* lookupPass;
    const ReflectionPass* reflectionPass;
    const RayPass* rayPass;
    const GpuRayScene* rayScene;  // this and the next two as `rayPass`
    RayHistory* rayHistory;
    RayCounter* rayCounter;
    const ShaderProgram* inspectProgram;  // inspect.frag, drawn instead of the light
    PassClock& clock;
    float environmentTurn = 0;  // see background.frag
    // Things that were not in the bake; null where there are none.
    const GpuAdded* added = nullptr;
    const ShaderProgram* addedProgram = nullptr;
};

void bindCamera(const ShaderProgram& program, const CameraMatrices& matrices, const Camera& camera);

/// Direct, glossy indirect and diffuse indirect light: 1 for those that are shown.
glm::vec3 shownParts(Component component);

/// Binds the view, what is shown of the light, and what a program needs for light that is not glossy.
void bindDiffuse(const ShaderProgram& program, const DisplayInput& input, const CameraMatrices& matrices,
                 const FrameSettings& settings);
/// Binds a display program's tables, and where its glossy light is: pictures that were looked up, with the
/// layers of rays if `traced`, or the pyramid.
void bindShared(const ShaderProgram& program, const DisplayInput& input, const CameraMatrices& matrices,
                const FrameSettings& settings, const LookupTargets* looked, bool traced = false);

void setCulling(const Material& material);
/// A surface by a program of the display pass.
void drawSurface(const ShaderProgram& program, const DisplayInput& input, const DrawRange& draw);
/// All opaque surfaces, where their depth is in the target already.
void drawOpaque(const ShaderProgram& program, const DisplayInput& input);
/// The same by a program that reads no material.
void drawOpaqueShapes(const ShaderProgram& program, const DisplayInput& input);

}  // namespace phat
