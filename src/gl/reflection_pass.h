#pragma once
// Smooth lobes by rays: what the rasteriser shows goes to core/smooth_reflections.h, what comes back to
// display.frag.

#include "core/smooth_reflections.h"
#include "gl/gl_objects.h"
#include "gl/shader_loader.h"

namespace phat {

struct ReflectionPass {
    ShaderProgram program;
    bool clearcoat = false;
};

/// Throws GlError.
ReflectionPass createReflectionPass(const std::string& shaderFolder, bool clearcoat);

/// Of the frame's size.
struct ReflectionTargets {
    glm::uvec2 size{0};
    GlTexture base, coat, surface;  // see smooth_surfaces.frag
    GlFramebuffer target;
};
ReflectionTargets createReflectionTargets(glm::uvec2 size, GLuint depth);

/// Binds the cleared targets; the caller draws its opaque surfaces with `program`.
void beginReflections(const ReflectionTargets& targets);

/// The smooth surfaces that were drawn; `jitter`: where in the pixels, see jitterOf in display_pass.cpp.
std::vector<SmoothSurface> readSmoothSurfaces(const ReflectionTargets& targets, Reflections reflections,
                                              glm::vec2 jitter);

/// Writes what they see to layers `firstLayer` on of `pictures` (RGBA32UI): indirect and area, then the
/// coat's. The bits of RGB, and of the share in A.
void uploadReflections(const ReflectionPass& pass, const ReflectionTargets& targets,
                       std::span<const SmoothSurface> surfaces, std::span<const SeenBySurface> seen,
                       GLuint pictures, int firstLayer);

}  // namespace phat
