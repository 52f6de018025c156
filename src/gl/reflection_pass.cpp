#include "gl/reflection_pass.h"

#include <glm/gtc/packing.hpp>

#include "gl/textures.h"

namespace phat {
namespace {

template <typename Pixel>
std::vector<Pixel> readPixels(GLuint texture, glm::uvec2 size, GLenum format, GLenum type) {
    std::vector<Pixel> pixels(size_t(size.x) * size.y);
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glGetTextureImage(texture, 0, format, type, GLsizei(pixels.size() * sizeof(Pixel)), pixels.data());
    return pixels;
}

TracedLobe lobeOf(glm::vec4 normalAlpha, glm::vec2 reflectance, uint32_t traced) {
    const glm::vec2 weightDistance = glm::unpackHalf2x16(traced);
    return {glm::vec3(normalAlpha), normalAlpha.a,    reflectance.x,
            reflectance.y,          weightDistance.x, weightDistance.y};
}

}  // namespace

ReflectionPass createReflectionPass(const std::string& folder, bool clearcoat) {
    std::vector<std::string> defines;
    if (clearcoat) defines.push_back("CLEARCOAT");
    return {ShaderProgram(folder, "surface.vert", "traced_surfaces.frag", defines), clearcoat};
}

ReflectionTargets createReflectionTargets(glm::uvec2 size, GLuint depth) {
    ReflectionTargets t;
    t.size = size;
    t.base = createTexture2D(GL_RGBA32F, size);
    t.coat = createTexture2D(GL_RGBA32F, size);
    t.surface = createTexture2D(GL_RGBA32UI, size);
    t.target = createFramebuffer({{t.base.name()}, {t.coat.name()}, {t.surface.name()}}, depth);
    checkGl("creating the reflections' targets");
    return t;
}

void beginReflections(const ReflectionPass& pass, const GpuAtlas& atlas, const GpuLookup& lookup,
                      const ReflectionTargets& targets, Reflections reflections, uint32_t frame) {
    glBindFramebuffer(GL_FRAMEBUFFER, targets.target.name());
    const GLfloat nothing[4] = {0, 0, 0, 0};
    const GLuint noTriangle[4] = {0, 0, 0, 0};
    glClearBufferfv(GL_COLOR, 0, nothing);
    glClearBufferfv(GL_COLOR, 1, nothing);
    glClearBufferuiv(GL_COLOR, 2, noTriangle);
    pass.program.bind("tilePatches", 0, atlas.tilePatches.name());
    pass.program.bind("charts", 1, atlas.charts.name());
    pass.program.bind("probes", 2, lookup.probes.name());
    pass.program.set("unitMeters", atlas.unitMeters);
    pass.program.set("frame", int(frame));
    pass.program.set("tracesAll", int(reflections == Reflections::rays));
}

std::vector<TracedSurface> readTracedSurfaces(const ReflectionTargets& targets, glm::vec2 jitter) {
    const glm::uvec2 size = targets.size;
    const auto base = readPixels<glm::vec4>(targets.base.name(), size, GL_RGBA, GL_FLOAT);
    const auto coat = readPixels<glm::vec4>(targets.coat.name(), size, GL_RGBA, GL_FLOAT);
    const auto surface =
        readPixels<glm::uvec4>(targets.surface.name(), size, GL_RGBA_INTEGER, GL_UNSIGNED_INT);
    std::vector<TracedSurface> surfaces;
    for (size_t i = 0; i < surface.size(); ++i) {
        if (surface[i].x == 0) continue;
        const TracedLobe baseLobe = lobeOf(base[i], glm::unpackHalf2x16(surface[i].y), surface[i].z);
        const TracedLobe coatLobe = lobeOf(coat[i], glm::vec2(kClearcoatF0, 1), surface[i].w);
        if (baseLobe.weight <= 0.0f && coatLobe.weight <= 0.0f) continue;
        // OpenGL's rows begin at the bottom.
        const glm::vec2 corner(uint32_t(i) % size.x, size.y - 1 - uint32_t(i) / size.x);
        // The frame was shifted by the jitter; the point at the pixel's centre is shifted in the opposite
        // direction.
        surfaces.push_back({uint32_t(i), corner + 0.5f + glm::vec2(-jitter.x, jitter.y),
                            (surface[i].x - 1) / 2, (surface[i].x - 1) % 2 == 1, baseLobe, coatLobe});
    }
    return surfaces;
}

void uploadReflections(const ReflectionPass& pass, const ReflectionTargets& targets,
                       std::span<const TracedSurface> surfaces, std::span<const SurfaceIncident> incident,
                       GLuint pictures, int firstLayer) {
    const auto upload = [&](int layer, const auto& valueOf) {
        std::vector<glm::vec4> pixels(size_t(targets.size.x) * targets.size.y, glm::vec4(0));
        for (size_t i = 0; i < surfaces.size(); ++i) pixels[surfaces[i].pixel] = valueOf(incident[i]);
        glTextureSubImage3D(pictures, 0, 0, 0, firstLayer + layer, GLsizei(targets.size.x),
                            GLsizei(targets.size.y), 1, GL_RGBA_INTEGER, GL_UNSIGNED_INT, pixels.data());
    };
    const auto uploadLobe = [&](int layer, LobeIncident SurfaceIncident::*lobe) {
        upload(layer,
               [=](const SurfaceIncident& s) { return glm::vec4((s.*lobe).indirect, (s.*lobe).weight); });
        upload(layer + 1,
               [=](const SurfaceIncident& s) { return glm::vec4((s.*lobe).area, (s.*lobe).weight); });
    };
    uploadLobe(0, &SurfaceIncident::base);
    if (pass.clearcoat) uploadLobe(2, &SurfaceIncident::coat);
}

}  // namespace phat
