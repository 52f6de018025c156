#include "gl/scene_upload.h"

#include <bit>
#include <cstddef>

#include "core/scene/brdf.h"
#include "gl/atlas_sides.h"
#include "gl/material_table.h"
#include "gl/textures.h"

namespace phat {
namespace {

// twin: the inputs of shaders/surface.vert.
struct Vertex {
    glm::vec3 position;
    glm::vec3 normal;
    glm::vec4 tangent;
    glm::vec2 uv0;
    glm::vec2 uv1;
    glm::vec4 color;
    glm::vec2 texelFront;
    glm::vec2 texelBack;
    glm::uvec2 charts;
};

std::vector<Vertex> expandTriangles(const Scene& scene, const Atlas& atlas) {
    std::vector<Vertex> vertices;
    vertices.reserve(scene.triangles.size() * 3);
    for (uint32_t t = 0; t < scene.triangles.size(); ++t) {
        const AtlasSides sides = atlasSidesOf(atlas, t);
        for (int corner = 0; corner < 3; ++corner) {
            const uint32_t v = scene.triangles[t][corner];
            const glm::vec2 texel = atlas.triangleTexels[t][corner];
            vertices.push_back({scene.positions[v], scene.normals[v], scene.tangents[v], scene.uv0[v],
                                scene.uv1[v], scene.colors[v], texel + sides.frontOffset,
                                texel + sides.backOffset, sides.charts});
        }
    }
    return vertices;
}

void describeVertices(GLuint vertexArray, GLuint buffer) {
    glVertexArrayVertexBuffer(vertexArray, 0, buffer, 0, sizeof(Vertex));
    GLuint location = 0;
    const auto floats = [&](GLint count, size_t offset) {
        glEnableVertexArrayAttrib(vertexArray, location);
        glVertexArrayAttribFormat(vertexArray, location, count, GL_FLOAT, GL_FALSE, GLuint(offset));
        glVertexArrayAttribBinding(vertexArray, location++, 0);
    };
    floats(3, offsetof(Vertex, position));
    floats(3, offsetof(Vertex, normal));
    floats(4, offsetof(Vertex, tangent));
    floats(2, offsetof(Vertex, uv0));
    floats(2, offsetof(Vertex, uv1));
    floats(4, offsetof(Vertex, color));
    floats(2, offsetof(Vertex, texelFront));
    floats(2, offsetof(Vertex, texelBack));
    glEnableVertexArrayAttrib(vertexArray, location);
    glVertexArrayAttribIFormat(vertexArray, location, 2, GL_UNSIGNED_INT, offsetof(Vertex, charts));
    glVertexArrayAttribBinding(vertexArray, location, 0);
}

GlTexture uploadImage(const TextureImage& image, bool srgb) {
    const glm::uvec2 size(image.width, image.height);
    const int levels = std::bit_width(std::max(size.x, size.y));
    GlTexture texture = createTexture2D(srgb ? GL_SRGB8_ALPHA8 : GL_RGBA8, size, levels);
    glTextureSubImage2D(texture.name(), 0, 0, 0, image.width, image.height, GL_RGBA, GL_UNSIGNED_BYTE,
                        image.texels.data());
    glGenerateTextureMipmap(texture.name());
    return texture;
}

void uploadImages(const Scene& scene, GpuScene& gpu) {
    gpu.imagesLinear.resize(scene.images.size());
    gpu.imagesSrgb.resize(scene.images.size());
    for (const Material& material : scene.materials) {
        for (const NamedSlot& named : kSlots) {
            const int32_t image = (material.*named.slot).image;
            if (image < 0 || scene.images[image]->texels.empty()) continue;
            GlTexture& texture = (named.srgb ? gpu.imagesSrgb : gpu.imagesLinear)[image];
            if (!texture) texture = uploadImage(scene.images[image], named.srgb);
        }
    }
    gpu.white = createTexture2D(GL_RGBA8, {1, 1});
    const glm::u8vec4 white(255);
    glTextureSubImage2D(gpu.white.name(), 0, 0, 0, 1, 1, GL_RGBA, GL_UNSIGNED_BYTE, &white);
}

size_t samplerIndex(const TextureSlot& slot) {
    return (size_t(slot.wrapU) * 3 + size_t(slot.wrapV)) * 2 + (slot.nearest ? 1 : 0);
}

// In the order of samplerIndex; filterTextures() says how they minify.
std::vector<GlSampler> createSamplers() {
    std::vector<GlSampler> samplers;
    const GLenum wraps[] = {GL_REPEAT, GL_MIRRORED_REPEAT, GL_CLAMP_TO_EDGE};
    for (GLenum wrapU : wraps)
        for (GLenum wrapV : wraps)
            for (GLenum magnified : {GL_LINEAR, GL_NEAREST})
                samplers.push_back(createSampler(wrapU, wrapV, magnified, magnified));
    return samplers;
}

// 1 where the driver knows of no such filter. twin: the anisotropy of web/viewer/viewer.js.
float maxAnisotropy() {
    float limit = 1;
    if (epoxy_has_gl_extension("GL_EXT_texture_filter_anisotropic") ||
        epoxy_has_gl_extension("GL_ARB_texture_filter_anisotropic"))
        glGetFloatv(GL_MAX_TEXTURE_MAX_ANISOTROPY, &limit);
    return std::min(limit, 8.0f);  // beyond 8 textures at grazing angles hardly become sharper
}

std::vector<DrawRange> drawRanges(const Scene& scene) {
    std::vector<DrawRange> ranges;
    for (const Surface& surface : scene.surfaces) {
        if (surface.triangleCount == 0) continue;
        Bounds bounds;
        for (uint32_t t = 0; t < surface.triangleCount; ++t)
            for (int corner = 0; corner < 3; ++corner)
                bounds.add(scene.positions[scene.triangles[surface.firstTriangle + t][corner]]);
        ranges.push_back({GLint(surface.firstTriangle * 3), GLsizei(surface.triangleCount * 3),
                          surface.material, uint32_t(&surface - scene.surfaces.data()), bounds.center(),
                          surface.metersPerUnit});
    }
    return ranges;
}

}  // namespace

GpuScene uploadScene(const Scene& scene, const Atlas& atlas) {
    GpuScene gpu;
    GLuint name = 0;
    glCreateVertexArrays(1, &name);
    gpu.vertexArray = GlVertexArray(name);
    glCreateBuffers(1, &name);
    gpu.vertices = GlBuffer(name);
    const std::vector<Vertex> vertices = expandTriangles(scene, atlas);
    if (!vertices.empty())
        glNamedBufferStorage(name, GLsizeiptr(vertices.size() * sizeof(Vertex)), vertices.data(),
                             GL_DYNAMIC_STORAGE_BIT);
    describeVertices(gpu.vertexArray.name(), name);
    gpu.drawRanges = drawRanges(scene);
    gpu.bounds = boundsOf(scene);

    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    uploadImages(scene, gpu);
    gpu.samplers = createSamplers();
    filterTextures(gpu, PixelFilter::box);
    gpu.splitSum = createTexture2D(GL_RG32F, glm::uvec2(kSplitSumSize));
    glTextureSubImage2D(gpu.splitSum.name(), 0, 0, 0, kSplitSumSize, kSplitSumSize, GL_RG, GL_FLOAT,
                        splitSumTable().data());
    if (scene.environment) gpu.environment = uploadEnvironment(*scene.environment);
    checkGl("uploading the scene");
    return gpu;
}

void filterTextures(GpuScene& gpu, PixelFilter filter) {
    if (gpu.filtered == filter) return;
    gpu.filtered = filter;
    const bool points = filter == PixelFilter::center;
    const float anisotropy = maxAnisotropy();
    for (size_t i = 0; i < gpu.samplers.size(); ++i) {
        const GLuint name = gpu.samplers[i].name();
        const bool nearest = i % 2 == 1;
        const GLenum one = nearest ? GL_NEAREST : GL_LINEAR;
        const GLenum many = nearest ? GL_NEAREST_MIPMAP_LINEAR : GL_LINEAR_MIPMAP_LINEAR;
        glSamplerParameteri(name, GL_TEXTURE_MIN_FILTER, GLint(points ? one : many));
        if (anisotropy > 1)
            glSamplerParameterf(name, GL_TEXTURE_MAX_ANISOTROPY, points || nearest ? 1.0f : anisotropy);
    }
}

void moveScene(GpuScene& gpu, const Scene& scene, const Atlas& atlas) {
    const std::vector<Vertex> vertices = expandTriangles(scene, atlas);
    if (!vertices.empty())
        glNamedBufferSubData(gpu.vertices.name(), 0, GLsizeiptr(vertices.size() * sizeof(Vertex)),
                             vertices.data());
    gpu.drawRanges = drawRanges(scene);
    gpu.bounds = boundsOf(scene);
    checkGl("moving the scene");
}

void bindMaterial(const GpuScene& gpu, const ShaderProgram& program, const Material& material, int firstUnit,
                  BoundSlots slots, float metersPerUnit) {
    program.set("material", packMaterial(material, metersPerUnit));
    const int count = slots == BoundSlots::baseColor ? 1
                      : slots == BoundSlots::opaque  ? kOpaqueSlots
                                                     : kSlotCount;
    for (int i = 0; i < count; ++i) {
        const TextureSlot& slot = material.*kSlots[i].slot;
        const auto& images = kSlots[i].srgb ? gpu.imagesSrgb : gpu.imagesLinear;
        const bool bound = slot.image >= 0 && images[slot.image];
        program.bind(kSlots[i].sampler, firstUnit + i, bound ? images[slot.image].name() : gpu.white.name(),
                     gpu.samplers[samplerIndex(slot)].name());
    }
}

}  // namespace phat
