#include "core/atlas/dilate.h"

#include <tbb/parallel_for.h>

namespace phat {
namespace {

// The known texels of one chart that its texels are nearest to. source: Danielsson 1980, "Euclidean Distance
// Mapping": two sweeps, each of rows in both directions; off by fractions of a texel at worst.
class NearestKnown {
  public:
    NearestKnown(const Chart& chart, const std::vector<uint8_t>& known, uint32_t atlasWidth)
        : size_(chart.sizeTexels()), nearest_(size_t(size_.x) * size_t(size_.y), kNone) {
        const glm::uvec2 origin = chart.originTexel();
        for (int y = 0; y < size_.y; ++y)
            for (int x = 0; x < size_.x; ++x)
                if (known[size_t(origin.y + uint32_t(y)) * atlasWidth + origin.x + uint32_t(x)])
                    nearest_[index({x, y})] = {x, y};
        for (int y = 0; y < size_.y; ++y) sweepRow(y, -1);
        for (int y = size_.y - 1; y >= 0; --y) sweepRow(y, 1);
    }

    /// Counted from the chart's origin; negative: the chart has no known texel.
    glm::ivec2 at(int x, int y) const { return nearest_[index({x, y})]; }

  private:
    static constexpr glm::ivec2 kNone{-1, -1};

    size_t index(glm::ivec2 p) const { return size_t(p.y) * size_t(size_.x) + size_t(p.x); }

    void offer(glm::ivec2 to, glm::ivec2 from) {
        if (from.x < 0 || from.y < 0 || from.x >= size_.x || from.y >= size_.y) return;
        const glm::ivec2 candidate = nearest_[index(from)];
        glm::ivec2& nearest = nearest_[index(to)];
        const auto squared = [&](glm::ivec2 p) {
            return (p.x - to.x) * (p.x - to.x) + (p.y - to.y) * (p.y - to.y);
        };
        if (candidate.x >= 0 && (nearest.x < 0 || squared(candidate) < squared(nearest))) nearest = candidate;
    }

    // `before`: the row that was swept before this one, -1 above or 1 below.
    void sweepRow(int y, int before) {
        for (int x = 0; x < size_.x; ++x) {
            for (int aside = -1; aside <= 1; ++aside) offer({x, y}, {x + aside, y + before});
            offer({x, y}, {x - 1, y});
        }
        for (int x = size_.x - 1; x >= 0; --x) offer({x, y}, {x + 1, y});
    }

    glm::ivec2 size_;
    std::vector<glm::ivec2> nearest_;
};

}  // namespace

void dilateWithinCharts(std::vector<glm::vec3>& values, const std::vector<uint8_t>& known,
                        const Atlas& atlas) {
    tbb::parallel_for(size_t(0), atlas.charts.size(), [&](size_t c) {
        const Chart& chart = atlas.charts[c];
        const NearestKnown nearest(chart, known, atlas.sizeTexels.x);
        const glm::uvec2 origin = chart.originTexel(), size = chart.sizeTexels();
        const auto indexOf = [&](glm::uvec2 p) {
            return size_t(origin.y + p.y) * atlas.sizeTexels.x + origin.x + p.x;
        };
        for (uint32_t y = 0; y < size.y; ++y)
            for (uint32_t x = 0; x < size.x; ++x) {
                const glm::ivec2 from = nearest.at(int(x), int(y));
                if (!known[indexOf({x, y})] && from.x >= 0) values[indexOf({x, y})] = values[indexOf(from)];
            }
    });
}

}  // namespace phat
