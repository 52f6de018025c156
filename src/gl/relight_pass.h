#pragma once
// Passes 1 and 2 over the atlas: the BRDF on every PHATexel, the pyramid of sums, the cones' radii.

#include <vector>

#include "core/scene/scene.h"
#include "gl/fullscreen.h"
#include "gl/gl_objects.h"
#include "gl/phatexture_upload.h"
#include "gl/texel_surfaces.h"

namespace phat {

/// twin: kTopLevel in shaders/lib/cone.glsl.
inline constexpr int kTopLevel = 3;

struct RelightPass {
    FullscreenProgram material;
    std::vector<FullscreenProgram> relight;  // [source]
    FullscreenProgram pyramid, radius;

    bool clearcoat = false;
    bool paper = false;    // indirect light as the paper has it, see shaders/relight_paper.frag
    int lobeCount = 0;     // sources, twice with clear coats; and with `paper` irradiance
    GlTexture texelBrdf;   // RGBA16F, see shaders/texel_material.frag
    GlTexture lobes;       // RGBA32F [lobe][y][x], levels 0 to 3: sum a L, sum w
    GlTexture statistics;  // RG32F, the same; see shaders/relight.frag
    GlTexture radii;       // RGBA32F [lobe][tileY][tileX]: radius, radiance bound
    GlFramebuffer brdfTarget;
    std::vector<GlFramebuffer> relightTargets;               // [source]
    std::vector<std::vector<GlFramebuffer>> pyramidTargets;  // [lobe][level - 1]
    std::vector<GlFramebuffer> radiusTargets;                // [lobe]
};

/// `clearcoat`: whether any material has a coat now. Throws GlError.
RelightPass createRelightPass(const std::string& shaderFolder, const GpuAtlas& atlas, bool clearcoat,
                              bool paper);

/// Applies the materials' factors to the texels' textures.
void applyMaterials(const RelightPass& pass, const GpuAtlas& atlas, const GpuTexelSurfaces& surfaces,
                    const std::vector<Material>& materials);

/// Where the eye is; for parallel projections the direction toward it.
struct Eye {
    glm::vec3 position{0};
    bool atInfinity = false;
};
void relight(const RelightPass& pass, const GpuAtlas& atlas, const GpuTexelSurfaces& surfaces,
             GLuint splitSum, const Eye& eye);
void buildPyramid(const RelightPass& pass, const GpuAtlas& atlas);

}  // namespace phat
