#pragma once
// PHATexels as samples in world space, found by position instead of by texel: a neighbourhood crosses the
// borders of charts, where the surface goes on.

#include <memory>
#include <span>
#include <vector>

#include "core/atlas/atlas.h"
#include "core/phatexel/phatexture.h"

namespace phat {

/// A PHATexel where it is in the world.
struct WorldPhatexel {
    glm::vec3 origin{0};   // the texel's centre
    float inversePdf = 0;  // sr
    glm::vec3 end{0};    // where the light came from; the unit direction toward it where it is infinitely far
    float distance = 0;  // metres from origin to end, or kFarDistance
    glm::vec3 radiance{0};  // W/(m2 sr)
    uint32_t surface = 0;   // Scene::surfaces
};

/// Valid PHATexels of one source of light (all its layers), tile by tile.
struct TiledPhatexels {
    std::vector<WorldPhatexel> phatexels;
    std::vector<uint32_t> first;  // [tile of SurfaceTiles], one more at the end

    std::span<const WorldPhatexel> inTile(uint32_t tile) const {
        return {phatexels.data() + first[tile], phatexels.data() + first[tile + 1]};
    }
};

/// The 8x8 tiles of an atlas that have valid texels, in the world.
class SurfaceTiles {
  public:
    struct Tile {
        glm::vec3 center{0};
        float radius = 0;     // metres, of a sphere around its valid texels' centres
        glm::vec3 normal{0};  // mean of its valid texels'; unit
        glm::uvec2 originTexel{0};
        uint32_t chart = 0;
        uint32_t firstSurface = ~0u, lastSurface = 0;  // the least and the largest of its valid texels'
    };

    SurfaceTiles(const Atlas& atlas, const TexelPoints& points);
    ~SurfaceTiles();
    SurfaceTiles(SurfaceTiles&&) noexcept;

    const Tile& operator[](uint32_t tile) const { return tiles_[tile]; }
    uint32_t count() const { return uint32_t(tiles_.size()); }

    /// Tiles that may have texels within `radius` metres of a point; ascending. `out` is cleared first.
    void near(glm::vec3 position, float radius, std::vector<uint32_t>& out) const;

  private:
    struct Tree;
    std::vector<Tile> tiles_;
    float largestRadius_ = 0;
    std::unique_ptr<Tree> tree_;
};

/// `frames`: blockFrames of the atlas.
TiledPhatexels tilePhatexels(const SurfaceTiles& tiles, const std::vector<PhatexelLayer>& layers,
                             const std::vector<Guide>& guides, const Atlas& atlas, const TexelPoints& points,
                             const std::vector<Frame>& frames);

}  // namespace phat
