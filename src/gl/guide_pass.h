#pragma once
// The guides of blocks follow the light that their PHATexels meet: gather_guides.frag, tabulate_guides.frag.

#include "gl/fullscreen.h"
#include "gl/lookup_pass.h"
#include "gl/phatexture_upload.h"
#include "gl/texel_batch.h"

namespace phat {

/// All guides, those of the area lights last, as what draws directions reads them.
struct GpuGuides {
    GlTexture sums;   // R32UI, see shaders/lib/guide_direction.glsl
    GlTexture cells;  // RG32F, see gather_guides.frag
};
/// Throws GlError.
GpuGuides uploadGuideSums(const Phatexture& phatexture);

struct GuidePass {
    FullscreenProgram gather, tabulate;
    // Of a batch.
    GlTexture cells, sums, inverseCdfs, densities;
    GlFramebuffer cellsTarget, tablesTarget;
};
GuidePass createGuidePass(const std::string& shaderFolder);

/// Of one kind of light of the blocks of a batch.
struct GuideTurn {
    const TexelBatch& batch;
    const GpuPhatexels& source;
    std::span<const uint16_t> scrambles;  // [block], of its first layer
    int firstGuide;                       // of all

    /// One guide for all blocks stays.
    bool follows() const { return source.guideCount > 1; }
};
/// Makes the guides from the PHATexels, which are drawn by them from now on. pre: turn.follows().
void followGuides(const GuidePass& pass, const GpuGuides& guides, const GuideTurn& turn,
                  const GlTexture& phatexels);
/// Shows them to whoever reads PHATexels. pre: the blocks' first layer is drawn by them.
void showGuides(const GuidePass& pass, const GuideTurn& turn, const GpuLookup& lookup);

}  // namespace phat
