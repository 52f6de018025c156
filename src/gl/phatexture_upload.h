#pragma once
// The atlas and the PHATexels on the GPU.

#include "core/atlas/atlas.h"
#include "core/dynamic/light_update.h"
#include "core/phatexel/phatexture.h"
#include "core/scene/scene.h"
#include "gl/gl_objects.h"
#include "gl/light_round.h"

namespace phat {

/// One kind of light's PHATexels.
struct GpuPhatexels {
    GlTexture guidePdf;  // R32F, see squareToGuidePdf in shaders/lib/phatexel.glsl
    GlTexture texelPdf;  // R32F [layer][y][x], only where the pdf does not follow from the guides
    int firstLayer = 0;  // of GpuAtlas::phatexels
    int layerCount = 0;
    int guideCount = 0;
};

struct GpuAtlas {
    glm::uvec2 sizeTexels{0};
    float coarsestTexelMeters = 0;
    float unitMeters = 1;   // Atlas::unitMeters, for the programs that read distances
    GlTexture tileTable;    // RGBA32UI: chart, block, the chart's texel size in metres (a float's bits)
    GlTexture tilePatches;  // RGBA32UI [tileY][2 tileX], see packTile
    GlTexture charts;       // RGBA32UI table: origin and size in tiles (y << 16 | x), first block, texel size
    GlTexture tileLight;    // RGBA32F [tileY][tileX], see tileLight()
    GlTexture irradiance;   // RGBA16F: indirect, area
    GlTexture phatexels;    // RG32UI [layer][y][x]: the sources' one after the other
    std::vector<GpuPhatexels> sources;  // indirect, then area if there is any
};

/// Throws GlError.
GpuAtlas uploadAtlas(const Scene& scene, const Atlas& atlas, const Phatexture& phatexture);

/// Parts of it anew. `block`: of LightUpdate::Guides.
void updatePhatexels(const GpuAtlas& gpu, const LightUpdate::Phatexels& tile);
void updateIrradiance(const GpuAtlas& gpu, const LightUpdate::Irradiance& tile);
void updateTilePatch(const GpuAtlas& gpu, const LightUpdate::TileGeometry& tile);
void updateGuides(const GpuAtlas& gpu, const LightUpdate::Guides& block);
void updateTileLight(const GpuAtlas& gpu, const std::vector<glm::vec4>& light);

/// Waits for the GPU.
StoredLight readLight(const GpuAtlas& gpu);

}  // namespace phat
