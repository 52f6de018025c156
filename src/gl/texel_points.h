#pragma once
// The surface points of the atlas's texels, from which the GPU traces rays: shaders/lib/texel_point.glsl.

#include <span>

#include "core/atlas/atlas.h"
#include "core/scene/scene.h"
#include "gl/gl_objects.h"
#include "gl/phatexture_upload.h"
#include "gl/shader_loader.h"

namespace phat {

/// [y][x] of the atlas, of the scene at rest.
struct GpuTexelPoints {
    GlTexture points;       // RGBA32UI: position, flat normal (octahedral); NaN where there is none
    GlTexture normals;      // R32UI: interpolated normal, octahedral, see shaders/lib/texel_point.glsl
    GlTexture restNormals;  // the same, as if nothing covered them
    GlTexture poses;        // RGBA32F table: three rows of each chart's world-from-rest matrix
};

/// Whether a texel is on a surface that something may cover, or leave; gutters that the bake found covered
/// stay so.
bool mayBeCovered(const TexelPoints& points, size_t texel);

/// pre: `scene` and `points` are at rest. Throws GlError.
GpuTexelPoints uploadTexelPoints(const Scene& scene, const Atlas& atlas, const TexelPoints& points);
/// Everything to where it is now. `worldFromRest`: as SceneState has it.
void moveTexelPoints(GpuTexelPoints& gpu, const Scene& scene, const Atlas& atlas,
                     std::span<const glm::mat4> worldFromRest);

inline constexpr int kTexelPointUnits = 4;
/// Binds what lib/texel_point.glsl reads to the units from `firstUnit` on.
void bindTexelPoints(const GpuTexelPoints& gpu, const GpuAtlas& atlas, const ShaderProgram& program,
                     int firstUnit);

}  // namespace phat
