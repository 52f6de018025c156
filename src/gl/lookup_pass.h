#pragma once
// Light on glossy surfaces, looked up by the pixel: lobes.frag, lookup.frag and pool.frag.

#include <vector>

#include "gl/fullscreen.h"
#include "gl/gl_objects.h"
#include "gl/phatexture_upload.h"
#include "gl/shader_loader.h"

namespace phat {

/// Textures that shaders/lib/lookup.glsl reads beside the PHATexels.
struct GpuLookup {
    GlTexture inverseCdfs;  // RGBA8, 16x16 a guide; the area lights' guides come last
    GlTexture probes;       // RGBA32UI [4 tileY][2 tileX]: 8x4 levels of a DepthProbe each
    GlTexture scrambles;    // R16UI [block row][layer][block], where there are several layers
    int guideCount = 0;     // of the indirect light; 0: these PHATexels cannot be looked up
    int layerCount = 0;
    int areaGuideCount = 0;  // 0: no area lights
};
/// Throws GlError.
GpuLookup uploadLookup(const Phatexture& phatexture, const Atlas& atlas);

/// Parts of it anew.
void updateLookupGuides(const GpuLookup& gpu, const LightUpdate::Guides& block);
void updateProbe(const GpuLookup& gpu, const LightUpdate::TileGeometry& tile, glm::uvec2 sizeTiles);

/// The defines of programs that read these PHATexels.
std::vector<std::string> phatexelDefines(const GpuLookup& lookup);

/// Pictures between the passes, of the frame's size.
struct LookupTargets {
    glm::uvec2 size{0};
    GlTexture
        incident;  // RGBA32UI [layer], see shaders/lib/sums_out.glsl; then traced radiance, see display.frag
    GlTexture pooled;  // the same, pooled along the rows
    // See shaders/lib/lobe_pixels.glsl: RGBA32UI, RGBA32F, RGBA32F; the last only with clear coats.
    GlTexture reflectances, baseLobes, coatLobes;
    int layers = 0;  // of `incident`, that are the lookup's own
    GlFramebuffer incidentTarget, pooledTarget, lobesTarget;
};

struct LookupPass {
    ShaderProgram lobesProgram, lookupProgram;
    FullscreenProgram pool;
    bool clearcoat = false;
    bool areaLights = false;
};

/// `countReads`: the pictures hold how many texels were read for them. Throws GlError.
LookupPass createLookupPass(const std::string& shaderFolder, const GpuLookup& lookup, bool clearcoat,
                            bool countReads);
/// Whether the driver has compiled it.
bool isReady(const LookupPass& pass);
/// `traced`: with layers for traced radiance, see reflection_pass.h.
LookupTargets createLookupTargets(const LookupPass& pass, glm::uvec2 size, GLuint depth, bool traced);
/// How many layers of `incident` are the lookup's own.
inline int lookedUpLayers(const LookupPass& pass) {
    return (pass.clearcoat ? 2 : 1) * (pass.areaLights ? 2 : 1);
}

/// How many samples a pixel takes.
struct LookupSampling {
    int sampleCount = 8;  // directions of a lobe, at most 32
    int lightBits = 3;    // see shaders/lib/lookup.glsl
};
/// Binds what lib/lookup_tables.glsl reads to the units from `firstUnit` on. Returns the unit after the last.
int bindPhatexels(const ShaderProgram& program, const GpuAtlas& atlas, const GpuLookup& lookup,
                  int firstUnit);
/// Binds what lib/lobe_pixels.glsl reads to three units from `firstUnit` on.
inline constexpr int kLobeUnits = 3;
void bindLobes(const ShaderProgram& program, const LookupTargets& targets, int firstUnit);
/// Clears what the lookup writes, layers for traced radiance not included.
void clearSums(const LookupTargets& targets);
/// Clears the target of the lobes, which are drawn first.
void beginLobes(const LookupTargets& targets);
/// Clears the targets, binds the textures common to all surfaces, and reseeds the samples.
void beginLookup(const LookupPass& pass, const GpuAtlas& atlas, const GpuLookup& lookup,
                 const LookupTargets& targets, const LookupSampling& sampling, uint32_t seed);
/// Adds the neighbours' sums to each pixel's.
void poolSums(const LookupPass& pass, const LookupTargets& targets);

}  // namespace phat
