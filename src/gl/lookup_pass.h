#pragma once
// Indirect light on glossy surfaces, looked up by the pixel: lookup.frag and pool.frag.

#include "gl/gl_objects.h"
#include "gl/phatexture_upload.h"
#include "gl/relight_pass.h"
#include "gl/shader_loader.h"

namespace phat {

/// What shaders/lib/lookup.glsl reads beside the PHATexels.
struct GpuLookup {
    GlTexture warps;      // RGBA8, 16x16 a guide
    GlTexture probes;     // RGBA32UI [4 tileY][2 tileX]: 8x4 levels of a DistanceProbe each
    GlTexture scrambles;  // R16UI [block row][layer][block]
    int guideCount = 0;   // 0: these PHATexels cannot be looked up
    int layerCount = 0;
};
/// Throws GlError.
GpuLookup uploadLookup(const Phatexture& phatexture, const Atlas& atlas);

/// Parts of it anew.
void updateLookupGuides(const GpuLookup& gpu, const LiveUpdate::Guides& block);
void updateProbe(const GpuLookup& gpu, const LiveUpdate::Place& tile, glm::uvec2 sizeTiles);

/// Pictures between the passes, of the frame's size.
struct LookupTargets {
    GlTexture seen, seenCoat;      // RGBA32UI, see shaders/lib/packed_draws.glsl
    GlTexture pooled, pooledCoat;  // the same, pooled along the rows
    GlTexture places;              // RGBA32F, see lookup.frag
    GlTexture glossy;  // RGBA32F [lobe]: indirect, area lights, then their coats'; then the same by rays
    GlFramebuffer lookupTarget, acrossTarget, poolTarget;
};

struct LookupPass {
    ShaderProgram lookupProgram, poolAcrossProgram, poolProgram;
    GlVertexArray noVertices;
    bool clearcoat = false;
    bool areaLights = false;
};

/// `countReads`: the pictures hold how many texels were read for them. Throws GlError.
LookupPass createLookupPass(const std::string& shaderFolder, const GpuAtlas& atlas, const GpuLookup& lookup,
                            bool clearcoat, bool countReads);
/// `traced`: with layers for what rays see, see reflection_pass.h.
LookupTargets createLookupTargets(const LookupPass& pass, glm::uvec2 size, GLuint depth, bool traced);
/// How many layers of `glossy` are the lookup's own.
inline int lookedUpLayers(const LookupPass& pass) {
    return pass.clearcoat ? 4 : 2;
}

/// Clears the targets, binds what the lookup of every surface shares, and reseeds the
/// draws, at most 32 a pixel.
void beginLookup(const LookupPass& pass, const GpuAtlas& atlas, const GpuLookup& lookup,
                 const LookupTargets& targets, int drawCount, uint32_t seed);
/// From the surfaces' draws to `targets.glossy`.
void poolDraws(const LookupPass& pass, const GpuAtlas& atlas, const RelightPass& relit,
               const LookupTargets& targets);

}  // namespace phat
