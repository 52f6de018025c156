#pragma once
// The trees that shaders trace rays through, on the GPU.

#include "core/bvh/posed_bvh.h"
#include "gl/gl_objects.h"
#include "gl/shader_loader.h"

namespace phat {

struct GpuBvh {
    GlTexture nodes;      // RGBA32UI table: at rest, then the tree over the groups
    GlTexture triangles;  // RGBA32UI table
    GlTexture opacity;    // RGBA32UI table; empty where nothing is transparent
    GlTexture alphas;     // R8 table; as `opacity`
    BvhGrid grid;
    uint32_t nodesAtRest = 0;
    uint32_t root = 0;
    uint32_t firstTransparent = 0;
    uint32_t firstMaterial = 0;
};

/// Of the scene at rest; without a tree over the groups: call moveBvh() before it is used. `scene` has the
/// materials as they are now. Throws GlError.
GpuBvh uploadBvh(const Scene& scene, const SceneBvh& bvh);

/// Everything to where it is now.
void moveBvh(GpuBvh& gpu, const PosedBvh& posed);

/// What lets rays pass, after materials have changed.
void updateOpacity(GpuBvh& gpu, const Scene& scene, const SceneBvh& bvh);

/// The define that programs need for this scene, or nothing.
std::vector<std::string> bvhDefines(const SceneBvh& bvh);

inline constexpr int kBvhUnits = 4;
/// Binds what lib/bvh.glsl reads to the units from `firstUnit` on.
void bindBvh(const GpuBvh& gpu, const ShaderProgram& program, int firstUnit);

}  // namespace phat
