#include "core/render/phatexel_cloud.h"

#include <algorithm>

#include "core/base/point_tree.h"

namespace phat {
namespace {

// Collects without distances.
struct Found {
    float radiusSquared;
    std::vector<uint32_t>& tiles;

    size_t size() const { return tiles.size(); }
    bool full() const { return true; }
    float worstDist() const { return radiusSquared; }
    bool addPoint(float, uint32_t tile) {
        tiles.push_back(tile);
        return true;
    }
};

template <typename Visit>
void forTexels(glm::uvec2 origin, const Visit& visit) {
    for (uint32_t i = 0; i < kTileSize * kTileSize; ++i)
        visit(origin + glm::uvec2(i % kTileSize, i / kTileSize));
}

WorldPhatexel inWorld(const Phatexel& phatexel, glm::vec3 origin, const Frame& frame, uint32_t surface) {
    const glm::vec3 direction = glm::normalize(frame.toWorld(phatexel.directionBlock));
    const bool far = phatexel.distance >= kFarDistance;
    return {origin,
            1.0f / phatexel.pdf,
            far ? direction : origin + phatexel.distance * direction,
            phatexel.distance,
            phatexel.radiance,
            surface};
}

}  // namespace

struct SurfaceTiles::Tree {
    explicit Tree(std::vector<glm::vec3> points)
        : centers{std::move(points)}, adaptor(3, centers, nanoflann::KDTreeSingleIndexAdaptorParams(16)) {}

    PointCloud centers;
    PointTree adaptor;
};

SurfaceTiles::SurfaceTiles(const Atlas& atlas, const TexelPoints& points) {
    std::vector<glm::vec3> centers;
    for (uint32_t i = 0; i < atlas.tileChart.size(); ++i) {
        if (atlas.tileChart[i] == kNoChart) continue;
        Tile tile;
        tile.originTexel = kTileSize * glm::uvec2(i % atlas.sizeTiles().x, i / atlas.sizeTiles().x);
        tile.chart = atlas.tileChart[i];
        Bounds bounds;
        forTexels(tile.originTexel, [&](glm::uvec2 p) {
            const size_t texel = size_t(p.y) * atlas.sizeTexels.x + p.x;
            if (!points.valid(texel)) return;
            bounds.add(points.position[texel]);
            tile.normal += points.normal[texel];
            const uint32_t surface = atlas.triangleSurface[points.triangle[texel]];
            tile.firstSurface = std::min(tile.firstSurface, surface);
            tile.lastSurface = std::max(tile.lastSurface, surface);
        });
        if (bounds.empty() || glm::length(tile.normal) <= 0.0f) continue;
        tile.center = bounds.center();
        tile.radius = 0.5f * bounds.diagonal();
        tile.normal = glm::normalize(tile.normal);
        largestRadius_ = std::max(largestRadius_, tile.radius);
        tiles_.push_back(tile);
        centers.push_back(tile.center);
    }
    tree_ = std::make_unique<Tree>(std::move(centers));
}

SurfaceTiles::~SurfaceTiles() = default;
SurfaceTiles::SurfaceTiles(SurfaceTiles&&) noexcept = default;

void SurfaceTiles::near(glm::vec3 position, float radius, std::vector<uint32_t>& out) const {
    out.clear();
    if (tiles_.empty()) return;
    Found found{square(radius + largestRadius_), out};
    tree_->adaptor.findNeighbors(found, &position.x, nanoflann::SearchParams(32, 0, false));
    std::erase_if(out, [&](uint32_t tile) {
        return glm::distance(position, tiles_[tile].center) > radius + tiles_[tile].radius;
    });
    std::sort(out.begin(), out.end());
}

TiledPhatexels tilePhatexels(const SurfaceTiles& tiles, const std::vector<PhatexelLayer>& layers,
                             const std::vector<Guide>& guides, const Atlas& atlas, const TexelPoints& points,
                             const std::vector<Frame>& frames) {
    TiledPhatexels result;
    result.first.reserve(tiles.count() + 1);
    for (uint32_t i = 0; i < tiles.count(); ++i) {
        result.first.push_back(uint32_t(result.phatexels.size()));
        forTexels(tiles[i].originTexel, [&](glm::uvec2 p) {
            const size_t texel = size_t(p.y) * atlas.sizeTexels.x + p.x;
            if (!points.valid(texel)) return;
            for (const PhatexelLayer& layer : layers) {
                const Phatexel phatexel = phatexelAt(layer, guides, atlas, p);
                if (phatexel.valid && phatexel.pdf > 0.0f)
                    result.phatexels.push_back(inWorld(phatexel, points.position[texel],
                                                       frames[atlas.blockAt(p)],
                                                       atlas.triangleSurface[points.triangle[texel]]));
            }
        });
    }
    result.first.push_back(uint32_t(result.phatexels.size()));
    return result;
}

}  // namespace phat
