#pragma once
// The scene's triangles, pictures and samplers on the GPU.

#include <optional>
#include <vector>

#include "core/atlas/atlas.h"
#include "core/render/picture.h"
#include "core/scene/scene.h"
#include "gl/gl_objects.h"
#include "gl/shader_loader.h"

namespace phat {

/// One surface: a run of corners with one material.
struct DrawRange {
    GLint firstVertex = 0;
    GLsizei vertexCount = 0;
    uint32_t material = 0;
    glm::vec3 center{0};  // by which blended surfaces are sorted
};

struct GpuScene {
    GlVertexArray vertexArray;
    GlBuffer vertices;
    std::vector<DrawRange> drawRanges;
    std::vector<GlTexture> imagesLinear;  // [image], empty where no slot reads it so
    std::vector<GlTexture> imagesSrgb;
    GlTexture white;
    std::vector<GlSampler> samplers;      // see samplerIndex
    std::optional<PixelFilter> filtered;  // as the samplers are set
    GlTexture splitSum;
    GlTexture environment;  // empty without one
    GlSampler environmentSampler;
    Bounds bounds;
};

/// Throws GlError.
GpuScene uploadScene(const Scene& scene, const Atlas& atlas);

/// Moves everything to where it is in `scene`, which has the triangles of the one that was uploaded.
void moveScene(GpuScene& gpu, const Scene& scene, const Atlas& atlas);

/// How textures of materials are read from now on where a pixel covers several of their texels: `box` from
/// pictures of half their size and so on; `center` at the very point, as the path tracer reads them.
void filterTextures(GpuScene& gpu, PixelFilter filter);

/// Binds a material's uniforms; textures from unit `firstUnit` on when `allSlots`, else the base colour
/// alone.
void bindMaterial(const GpuScene& gpu, const ShaderProgram& program, const Material& material, int firstUnit,
                  bool allSlots);

}  // namespace phat
