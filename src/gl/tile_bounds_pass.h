#pragma once
// The bounds of the radiance around tiles (tileLight), of PHATexels that the GPU has made.

#include <string>

#include "gl/fullscreen.h"
#include "gl/phatexture_upload.h"

namespace phat {

struct TileBoundsPass {
    FullscreenProgram brightest, bounds;
    GlTexture indirect, area;  // RGBA32F [tileY][tileX]: the brightest PHATexel of each tile
    GlFramebuffer brightestTarget, boundsTarget;
};
TileBoundsPass createTileBoundsPass(const std::string& shaderFolder, const GpuAtlas& atlas);

/// Nothing bounds radiance, as long as PHATexels of an older scene are among those of a new one.
void unboundTiles(const TileBoundsPass& pass);
/// `brightest`: radiance that nothing exceeds.
void boundTiles(const TileBoundsPass& pass, const GpuAtlas& atlas, glm::vec3 brightest);

}  // namespace phat
