#include "core/atlas/atlas_pages.h"

#include <map>
#include <stdexcept>

#include "core/atlas/skyline.h"

namespace phat {
namespace {

// What the triangles of a part have in common.
struct PartKey {
    uint32_t page = 0;
    bool back = false, oneSided = false;

    auto operator<=>(const PartKey&) const = default;
};

class PartsOfSurface {
  public:
    PartsOfSurface(const Atlas& atlas, const AtlasPages& pages) : atlas_(atlas), pages_(pages) {}

    /// `chart`: which the triangle is drawn with, its own or that one's other side.
    void add(uint32_t triangle, uint32_t chart, bool back, bool oneSided) {
        const Chart& own = atlas_.charts[atlas_.triangleChart[triangle]];
        const AtlasPages::Place& place = pages_.place[chart];
        const glm::vec2 to(place.originTile * kTileSize), from(own.originTexel());
        std::array<glm::vec2, 3> uvs = atlas_.triangleTexels[triangle];
        for (glm::vec2& uv : uvs)
            uv = glm::clamp((to + (uv - from) / float(place.coarser)) / glm::vec2(pages_.sizeTexels),
                            glm::vec2(0), glm::vec2(1));
        append({place.page, back, oneSided}, triangle, uvs);
    }

    /// Of a triangle without texels.
    void addDegenerate(uint32_t triangle) {
        append(parts_.empty() ? PartKey() : parts_.begin()->first, triangle, {});
    }

    std::vector<SurfacePart> take() {
        std::vector<SurfacePart> all;
        for (auto& [key, part] : parts_) all.push_back(std::move(part));
        return all;
    }

  private:
    void append(const PartKey& key, uint32_t triangle, const std::array<glm::vec2, 3>& uvs) {
        SurfacePart& part = parts_[key];
        part.page = key.page;
        part.back = key.back;
        part.oneSided = key.oneSided;
        part.triangles.push_back(triangle);
        part.uvs.push_back(uvs);
    }

    const Atlas& atlas_;
    const AtlasPages& pages_;
    std::map<PartKey, SurfacePart> parts_;
};

}  // namespace

AtlasPages pagesOf(const Atlas& atlas, uint32_t maxSideTexels) {
    AtlasPages pages;
    pages.sizeTexels = atlas.sizeTexels;
    for (const Chart& chart : atlas.charts) pages.place.push_back({0, chart.originTile});
    if (std::max(atlas.sizeTexels.x, atlas.sizeTexels.y) <= maxSideTexels) return pages;
    const uint32_t side = maxSideTexels / kTileSize;
    std::vector<glm::uvec2> sizes;
    for (size_t c = 0; c < atlas.charts.size(); ++c) {
        const glm::uvec2 size = atlas.charts[c].sizeTiles;
        uint32_t& coarser = pages.place[c].coarser;
        while (coarser < kMaxCoarser && std::max(size.x, size.y) > side * coarser) coarser *= 2;
        if (std::max(size.x, size.y) > side * coarser)
            throw std::runtime_error("pages of " + std::to_string(maxSideTexels) +
                                     " texels are too small for a chart with a side of " +
                                     std::to_string(std::max(size.x, size.y) * kTileSize));
        sizes.push_back((size + coarser - 1u) / coarser);
    }
    const SkylinePages packed = packSkylinePages(sizes, glm::uvec2(side));
    pages.count = packed.count;
    pages.sizeTexels = packed.size * kTileSize;
    for (size_t c = 0; c < sizes.size(); ++c) {
        pages.place[c].page = packed.page[c];
        pages.place[c].originTile = packed.origin[c];
    }
    return pages;
}

std::vector<glm::vec3> texelsOfPage(const std::vector<glm::vec3>& texels, const Atlas& atlas,
                                    const AtlasPages& pages, uint32_t page) {
    std::vector<glm::vec3> result(size_t(pages.sizeTexels.x) * pages.sizeTexels.y, glm::vec3(0));
    for (size_t c = 0; c < atlas.charts.size(); ++c) {
        if (pages.place[c].page != page) continue;
        const uint32_t coarser = pages.place[c].coarser;
        const glm::uvec2 from = atlas.charts[c].originTexel(), size = atlas.charts[c].sizeTexels(),
                         to = pages.place[c].originTile * kTileSize;
        // Texels of a tile are a multiple of kMaxCoarser, so that none is left over.
        for (uint32_t y = 0; y < size.y; ++y)
            for (uint32_t x = 0; x < size.x; ++x)
                result[size_t(to.y + y / coarser) * pages.sizeTexels.x + to.x + x / coarser] +=
                    texels[size_t(from.y + y) * atlas.sizeTexels.x + from.x + x] / float(coarser * coarser);
    }
    return result;
}

std::vector<std::vector<SurfacePart>> surfaceParts(const Scene& scene, const Atlas& atlas,
                                                   const AtlasPages& pages, PartSides sides) {
    std::vector<std::vector<SurfacePart>> all;
    for (const Surface& surface : scene.surfaces) {
        PartsOfSurface parts(atlas, pages);
        const uint32_t end = surface.firstTriangle + surface.triangleCount;
        for (uint32_t t = surface.firstTriangle; t < end; ++t) {
            const uint32_t chart = atlas.triangleChart[t];
            if (chart == kNoChart) continue;
            const uint32_t other = atlas.charts[chart].otherSide;
            const bool both = sides == PartSides::both && other != kNoChart &&
                              scene.materials[surface.material].doubleSided;
            parts.add(t, chart, false, both);
            if (both) parts.add(t, other, true, true);
        }
        for (uint32_t t = surface.firstTriangle; t < end; ++t)
            if (atlas.triangleChart[t] == kNoChart) parts.addDegenerate(t);
        all.push_back(parts.take());
    }
    return all;
}

}  // namespace phat
