#pragma once
// What the incremental baker sends to the renderer: copies, so that neither waits for the other.

#include <vector>

#include "core/atlas/atlas.h"
#include "core/phatexel/phatexture.h"

namespace phat {

inline constexpr size_t kTileTexels = size_t(kTileSize) * kTileSize;

struct LightUpdate {
    /// Texels of a tile, [y][x], of every layer of indirect light, then of the area lights if there are any.
    struct Phatexels {
        uint32_t tile = 0, block = 0;
        std::vector<PackedPhatexel> texels;
    };
    /// Both maps' texels [y][x] as Phatexture has them; area: of zeros where there are no area lights.
    struct Irradiance {
        uint32_t tile = 0;
        std::array<uint32_t, kTileTexels> indirect, area;
    };
    /// A tile's patch and depth probe.
    struct TileGeometry {
        uint32_t tile = 0;
        PackedTile packed;
        DepthProbe probe;
    };
    /// The directions of a block's PHATexels depend on its guide: all of its tiles come in the same update.
    struct Guides {
        uint32_t block = 0;
        Guide indirect, area;
        std::vector<uint16_t> scrambles;  // [layer], as Phatexels::texels
    };
    /// Which of a tile's texels are occluded: for the CPU's copy alone.
    struct Occlusion {
        uint32_t tile = 0;
        std::array<TexelState, kTileTexels> state;
    };
    std::vector<Phatexels> phatexels;  // by block
    std::vector<Irradiance> irradiance;
    std::vector<TileGeometry> tileGeometries;
    std::vector<Guides> guides;  // by block
    std::vector<Occlusion> occlusions;
    /// Only the noise differs: the same light by other random numbers, to be averaged with the frames
    /// shown.
    bool refined = false;
    std::vector<glm::vec4> tileLight;  // see tileLight(); of all tiles, or empty: as before

    bool empty() const {
        return phatexels.empty() && irradiance.empty() && tileGeometries.empty() && guides.empty() &&
               occlusions.empty() && tileLight.empty();
    }
};

/// Texel `inTile` ([y][x]) of a tile as an index into the atlas.
size_t texelOfTile(const Atlas& atlas, size_t tile, uint32_t inTile);

/// Brings a copy of the PHATexels, and of which texels are occluded, to the baker's state.
void applyUpdate(const LightUpdate& update, const Atlas& atlas, Phatexture& phatexture,
                 std::vector<TexelState>& states);

}  // namespace phat
