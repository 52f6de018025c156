#pragma once
// What shaders read of the surfaces that rays hit: shaders/lib/hit_surface.glsl.

#include "core/atlas/atlas.h"
#include "core/bvh/scene_bvh.h"
#include "gl/hit_images.h"
#include "gl/shader_loader.h"

namespace phat {

struct GpuHits {
    GlTexture table;  // RGBA32UI table: materials, triangles in the order of the leaves, emitters
    HitImages images;
    GlSampler filtered;
    uint32_t firstTriangle = 0, firstEmitter = 0;  // texels
    int emitterCount = 0;
};

/// Of everything where it is in `scene`, with its materials. Throws GlError.
GpuHits uploadHits(const Scene& scene, const Atlas& atlas, const SceneBvh& bvh);
/// After materials, or places of things, have changed: `scene` has the triangles of the one that was
/// uploaded.
void updateHits(GpuHits& gpu, const Scene& scene, const Atlas& atlas, const SceneBvh& bvh);

inline constexpr int kHitUnits = 3;
/// Binds what lib/hit_surface.glsl reads to the units from `firstUnit` on.
void bindHits(const GpuHits& gpu, const ShaderProgram& program, int firstUnit);

}  // namespace phat
