#pragma once
// Traced lobes: the visible surfaces go to core/render/traced_reflections.h, the radiance that comes back to
// display.frag.

#include "core/render/traced_reflections.h"
#include "gl/gl_objects.h"
#include "gl/lookup_pass.h"
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
    GlTexture base, coat, surface;  // see traced_surfaces.frag
    GlFramebuffer target;
};
ReflectionTargets createReflectionTargets(glm::uvec2 size, GLuint depth);

/// Binds the cleared targets and the textures common to all surfaces; the caller draws its opaque surfaces
/// with `program`.
void beginReflections(const ReflectionPass& pass, const GpuAtlas& atlas, const GpuLookup& lookup,
                      const ReflectionTargets& targets, Reflections reflections, uint32_t frame);

/// The surfaces that were drawn and are to be traced; `jitter`: where in the pixels, see jitterOf in
/// camera_matrices.h.
std::vector<TracedSurface> readTracedSurfaces(const ReflectionTargets& targets, glm::vec2 jitter);

/// Writes their incident radiance to layers `firstLayer` on of `pictures` (RGBA32UI): indirect and area, then
/// the coat's. The bits of RGB, and of the weight in A.
void uploadReflections(const ReflectionPass& pass, const ReflectionTargets& targets,
                       std::span<const TracedSurface> surfaces, std::span<const SurfaceIncident> incident,
                       GLuint pictures, int firstLayer);

}  // namespace phat
