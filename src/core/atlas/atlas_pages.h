#pragma once
// An atlas as several textures of a limited size, for renderers that take no larger ones.

#include "core/atlas/atlas.h"
#include "core/atlas/surface_part.h"

namespace phat {

/// How many times as wide texels may become where a chart is larger than a page: a gutter of four is one
/// then.
inline constexpr uint32_t kMaxCoarser = 4;

/// Charts move by whole tiles, so that every texel keeps its value and its place among its chart's texels.
struct AtlasPages {
    struct Place {
        uint32_t page = 0;
        glm::uvec2 originTile{0};
        uint32_t coarser = 1;  // how many times as wide as in the atlas the texels are; 1, 2 or 4
    };
    uint32_t count = 1;
    glm::uvec2 sizeTexels{0};  // of every page
    std::vector<Place> place;  // per chart
};

/// One page, the atlas as it is, where its sides are at most `maxSideTexels`. A chart that is larger than a
/// page is not cut, but coarser. Throws std::runtime_error where that would be more than kMaxCoarser.
AtlasPages pagesOf(const Atlas& atlas, uint32_t maxSideTexels);

/// The texels of one page, [y][x], of an array of [y][x] of the atlas; 0 where the page has no chart, the
/// mean of several where texels are coarser.
std::vector<glm::vec3> texelsOfPage(const std::vector<glm::vec3>& texels, const Atlas& atlas,
                                    const AtlasPages& pages, uint32_t page);

/// Which sides of double-sided triangles that have texels on both become parts.
enum class PartSides : uint8_t { both, front };

/// For each surface its triangles by page, with texture coordinates in that page. Degenerate triangles go
/// with the surface's first part.
std::vector<std::vector<SurfacePart>> surfaceParts(const Scene& scene, const Atlas& atlas,
                                                   const AtlasPages& pages,
                                                   PartSides sides = PartSides::both);

}  // namespace phat
