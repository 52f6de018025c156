#pragma once
// Light transport by the GPU: PHATexels and irradiance of blocks of the atlas made anew, one ray each.
// source: Hensley et al. 2003, section 8 (the graphics hardware updates PHATexels while it draws); how is
// ours: docs/dynamic.md, "On the GPU".

#include <array>
#include <vector>

#include "core/atlas/atlas.h"
#include "gl/fullscreen.h"
#include "gl/guide_pass.h"
#include "gl/light_round.h"
#include "gl/moved_texels.h"
#include "gl/ray_pass.h"
#include "gl/texel_points.h"
#include "gl/tile_bounds_pass.h"

namespace phat {

/// What is known of the light beside what frames are drawn from.
struct GpuLight {
    GpuTexelPoints points;
    MovedTexels moved;
    GpuGuides guides;
    GlTexture estimates;  // RGBA32UI [source][y][x], see shaders/lib/irradiance_estimate.glsl
    std::vector<BlockRect> blocks;
    std::vector<std::vector<uint16_t>> scrambles;  // [layer][block] of all sources
};
/// Throws GlError.
GpuLight createGpuLight(const Scene& scene, const Atlas& atlas, const TexelPoints& points,
                        const Phatexture& phatexture);

/// Programs, and pictures between them.
struct LightUpdatePass {
    GuidePass guides;
    MovedTexelsPass moved;
    TileBoundsPass bounds;
    FullscreenProgram trace, shade, lights, pack, compare, estimate, filterFirst, filter;
    GlTexture hits, places, codes;  // of the rays, see trace_texels.frag
    GlTexture indirect, area;       // RGBA16F: what they bring
    GlTexture packed;               // RG32UI PHATexels
    GlTexture changes;              // RG32F [source][y][x], see compare_phatexels.frag
    GlTexture indirectEstimate, areaEstimate;
    std::array<GlTexture, 2> filtered;  // RGBA16F [y][x] of the atlas
    GlFramebuffer raysTarget, lightTarget, areaTarget, packedTarget, estimateTarget;
    std::array<GlFramebuffer, 2> filteredTargets, changesTargets;
    std::vector<GlFramebuffer> irradianceTargets;  // [source]
};
LightUpdatePass createLightUpdatePass(const std::string& shaderFolder, const GpuAtlas& atlas,
                                      const GpuLookup& lookup, const std::vector<std::string>& bvhDefines);

/// PHATexels are replaced; irradiance is estimated better, and shown once it is filtered. Returns, where the
/// round compares, for each of its blocks what BlockOrder::noteCheck asks for.
std::vector<float> traceLight(const LightUpdatePass& pass, GpuLight& light, const LitWorld& world,
                              const LightRound& round);
/// The irradiance of all texels, from the estimates so far.
void filterIrradiance(const LightUpdatePass& pass, const GpuLight& light, const GpuAtlas& atlas);

}  // namespace phat
