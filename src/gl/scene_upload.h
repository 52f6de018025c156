#pragma once
// The scene's triangles, pictures and samplers on the GPU.

#include <optional>
#include <vector>

#include "core/atlas/atlas.h"
#include "core/render/picture.h"
#include "core/scene/scene.h"
#include "core/scene/transparency.h"
#include "gl/environment_upload.h"
#include "gl/gl_objects.h"
#include "gl/shader_loader.h"

namespace phat {

/// One surface: a run of corners with one material.
struct DrawRange {
    GLint firstVertex = 0;
    GLsizei vertexCount = 0;
    uint32_t material = 0;
    uint32_t surface = 0;
    glm::vec3 center{0};      // by which blended surfaces are sorted
    float metersPerUnit = 1;  // of Material::thickness
};

/// Materials of the drawn surfaces.
struct DrawnMaterials {
    const std::vector<Material>& materials;
    const std::vector<Glass>& glass;  // [surface] or nothing: glassOfSurfaces()

    const Material& of(const DrawRange& draw) const { return materials[draw.material]; }
    Glass glassOf(const DrawRange& draw) const { return glass.empty() ? Glass::none : glass[draw.surface]; }
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
    GpuEnvironment environment;
    Bounds bounds;
};

/// Throws GlError.
GpuScene uploadScene(const Scene& scene, const Atlas& atlas);

/// Moves everything to where it is in `scene`, which has the triangles of the one that was uploaded.
void moveScene(GpuScene& gpu, const Scene& scene, const Atlas& atlas);

/// How textures of materials are read from now on where a pixel covers several of their texels: `box` from
/// pictures of half their size and so on; `center` at the very point, as the path tracer reads them.
void filterTextures(GpuScene& gpu, PixelFilter filter);

/// Which of a material's texture slots a program reads.
enum class BoundSlots : uint8_t { baseColor, opaque, glass };
/// Binds a material's uniforms, and the textures of its slots from unit `firstUnit` on. `metersPerUnit`: of
/// the thickness of glass.
void bindMaterial(const GpuScene& gpu, const ShaderProgram& program, const Material& material, int firstUnit,
                  BoundSlots slots, float metersPerUnit = 1);

}  // namespace phat
