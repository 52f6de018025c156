#pragma once
// What depends on where things are, made anew where some have moved: which texels of the atlas are covered,
// and the depth probes around its tiles.

#include <span>
#include <string>
#include <vector>

#include "core/atlas/atlas.h"
#include "core/scene/scene.h"
#include "gl/fullscreen.h"
#include "gl/ray_pass.h"
#include "gl/texel_batch.h"
#include "gl/texel_points.h"

namespace phat {

/// What is known of the blocks.
struct MovedTexels {
    std::vector<Bounds> blockBounds;               // [block], at rest, of texels that something may cover
    std::vector<uint32_t> blockNode;               // [block]
    std::vector<Bounds> nodeBounds;                // [node], where it was last; empty: it has no surfaces
    std::vector<glm::mat4> worldFromRest;          // [node], as SceneState has it, when it was last noted
    std::vector<uint8_t> staleCover, staleProbes;  // [block]
};
/// pre: `rest` and `points` are at rest.
MovedTexels createMovedTexels(const Scene& rest, const Atlas& atlas, const TexelPoints& points);

/// Nodes are elsewhere: texels near them may be covered, or not any more, and all probes may see them.
/// `now`: the scene as it is.
void noteMotion(MovedTexels& moved, const Scene& now, std::span<const glm::mat4> worldFromRest);

/// Programs, and pictures between them.
struct MovedTexelsPass {
    FullscreenProgram cover, traceProbes, packProbes, packRanges;
    GlTexture normals;          // R32UI, see cover_texels.frag
    GlTexture codes;            // R8UI, see trace_probes.frag
    GlTexture levels, patches;  // RGBA32UI, see pack_probes.frag
    GlFramebuffer normalsTarget, codesTarget, levelsTarget, patchesTarget;
};
MovedTexelsPass createMovedTexelsPass(const std::string& shaderFolder,
                                      const std::vector<std::string>& bvhDefines);

/// Brings the blocks of a batch up to date whose turn it is: texels before anything else, probes not while
/// something moves on and on, in which case no block has a second round.
void updateMovedTexels(const MovedTexelsPass& pass, MovedTexels& moved, const GpuTexelPoints& points,
                       const LitWorld& world, const TexelBatch& batch);

}  // namespace phat
