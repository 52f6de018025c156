#include "gl/texel_surfaces.h"

#include <oneapi/tbb/parallel_for.h>

#include "core/base/octahedral.h"
#include "core/scene/shading.h"
#include "gl/gl_error.h"
#include "gl/textures.h"

namespace phat {
namespace {

uint8_t unorm8(float x) {
    return uint8_t(std::clamp(x, 0.0f, 1.0f) * 255.0f + 0.5f);
}

struct TexelTextures {
    glm::u8vec4 a{0}, b{0};
};

// The material's textures alone, without its factors, which may change. Means over the channels suffice: they
// only weigh PHATexels.
TexelTextures sampleTextures(const Scene& scene, uint32_t triangle, glm::vec2 barycentric) {
    const Material& m = scene.materialOf(triangle);
    const glm::uvec3 t = scene.triangles[triangle];
    glm::vec2 inside = glm::max(barycentric, glm::vec2(0));
    inside /= std::max(inside.x + inside.y, 1.0f);
    const glm::vec3 weights(1.0f - inside.x - inside.y, inside);
    const auto mix = [&](const auto& values) {
        return values[t.x] * weights.x + values[t.y] * weights.y + values[t.z] * weights.z;
    };
    const auto look = [&](const TextureSlot& slot, bool srgb) {
        if (slot.image < 0) return glm::vec4(1);
        return sampleTexture(scene, slot, slot.uvSet == 0 ? mix(scene.uv0) : mix(scene.uv1), srgb);
    };
    const glm::vec4 base = mix(scene.colors) * look(m.baseColorTexture, true);
    const glm::vec4 metallicRoughness = look(m.metallicRoughnessTexture, false);
    const glm::vec4 specularColor = look(m.specularColorTexture, true);
    return {
        {unorm8((base.r + base.g + base.b) / 3.0f), unorm8(metallicRoughness.g), unorm8(metallicRoughness.b),
         unorm8(look(m.specularTexture, false).a)},
        {unorm8((specularColor.r + specularColor.g + specularColor.b) / 3.0f),
         unorm8(look(m.clearcoatTexture, false).r), unorm8(look(m.clearcoatRoughnessTexture, false).g), 255}};
}

// visit(texel, triangle) for every texel on the extended plane of one; occluded ones may be disoccluded
// later.
template <class Visit>
void forTexels(const Atlas& atlas, const TexelPoints& points, const Visit& visit) {
    oneapi::tbb::parallel_for(size_t(0), size_t(atlas.sizeTexels.y), [&](size_t y) {
        const size_t wide = atlas.sizeTexels.x;
        for (size_t texel = y * wide; texel < (y + 1) * wide; ++texel)
            if (points.triangle[texel] != kNoTriangle) visit(texel, points.triangle[texel]);
    });
}

std::vector<glm::i16vec4> sampleNormals(const Scene& scene, const Atlas& atlas, const TexelPoints& points) {
    std::vector<glm::i16vec4> normals(atlas.texelCount(), glm::i16vec4(0));
    forTexels(atlas, points, [&](size_t texel, uint32_t triangle) {
        const glm::uvec2 texelXy(texel % atlas.sizeTexels.x, texel / atlas.sizeTexels.x);
        const bool back = atlas.charts[atlas.chartAt(texelXy)].back;
        const SurfacePoint at = surfaceAt(scene, triangle, points.barycentric[texel], back);
        const glm::vec3 coat = at.shading.toWorld(at.brdf.clearcoatNormal);
        const glm::vec4 folded(octahedralFromDirection(at.shading.normal), octahedralFromDirection(coat));
        normals[texel] = glm::i16vec4(glm::round(glm::clamp(folded, -1.0f, 1.0f) * 32767.0f));
    });
    return normals;
}

void upload(const GlTexture& texture, glm::uvec2 size, GLenum format, GLenum type, const void* data) {
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    glTextureSubImage2D(texture.name(), 0, 0, 0, GLsizei(size.x), GLsizei(size.y), format, type, data);
}

}  // namespace

GpuTexelSurfaces uploadTexelSurfaces(const Scene& scene, const Atlas& atlas, const TexelPoints& points) {
    const size_t count = atlas.texelCount();
    if (points.triangle.size() != count) throw GlError("the atlas and its texels differ in size");
    std::vector<uint32_t> material(count, 0);
    std::vector<glm::u8vec4> texturesA(count, glm::u8vec4(0)), texturesB(count, glm::u8vec4(0));
    forTexels(atlas, points, [&](size_t texel, uint32_t triangle) {
        material[texel] = scene.surfaces[scene.triangleSurface[triangle]].material;
        const TexelTextures textures = sampleTextures(scene, triangle, points.barycentric[texel]);
        texturesA[texel] = textures.a;
        texturesB[texel] = textures.b;
    });
    const glm::uvec2 size = atlas.sizeTexels;
    GpuTexelSurfaces gpu{createTexture2D(GL_RGBA16_SNORM, size), createTexture2D(GL_R32UI, size),
                         createTexture2D(GL_RGBA8, size), createTexture2D(GL_RGBA8, size)};
    updateNormals(gpu, scene, atlas, points);
    upload(gpu.materialIndex, size, GL_RED_INTEGER, GL_UNSIGNED_INT, material.data());
    upload(gpu.texturesA, size, GL_RGBA, GL_UNSIGNED_BYTE, texturesA.data());
    upload(gpu.texturesB, size, GL_RGBA, GL_UNSIGNED_BYTE, texturesB.data());
    checkGl("uploading the texels' surfaces");
    return gpu;
}

void updateNormals(const GpuTexelSurfaces& gpu, const Scene& scene, const Atlas& atlas,
                   const TexelPoints& points) {
    upload(gpu.normals, atlas.sizeTexels, GL_RGBA, GL_SHORT, sampleNormals(scene, atlas, points).data());
}

}  // namespace phat
