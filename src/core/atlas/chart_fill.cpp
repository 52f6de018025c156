#include "core/atlas/chart_fill.h"

#include "core/atlas/texel_neighbors.h"
#include "core/scene/rays.h"

namespace phat {
namespace {

// Interpolation, smoothing and stitching reach no farther; deeper under an object it is dark.
constexpr int kMaxRings = 4;

// Whether a value may go from one texel of a chart to another. To those without a point, that lie far from
// all surface, it may come from anywhere.
bool belongTogether(const Atlas& atlas, const TexelPoints& points, size_t from, size_t to) {
    if (points.triangle[to] == kNoTriangle) return true;
    return points.triangle[from] != kNoTriangle && lieTogether(atlas, points, from, to);
}

}  // namespace

void fillWithinCharts(std::vector<glm::vec3>& values, std::vector<uint8_t>& known, const Atlas& atlas,
                      const TexelPoints& points) {
    const glm::ivec2 size(atlas.sizeTexels);
    const auto indexOf = [&](glm::ivec2 p) { return size_t(p.y) * size.x + p.x; };
    const auto chartOf = [&](glm::ivec2 p) { return atlas.chartAt(glm::uvec2(p)); };

    // The open list is walked ring by ring, so the cost is that of the holes, not of the atlas.
    std::vector<glm::ivec2> open;
    for (int y = 0; y < size.y; ++y)
        for (int x = 0; x < size.x; ++x)
            if (!known[indexOf({x, y})] && chartOf({x, y}) != kNoChart) open.emplace_back(x, y);

    // A lookup interpolates between a chart's last texel and the first one beyond its edge. Were that a copy,
    // light that falls off across the surface would jump where two charts meet; so the first ring continues
    // its slope.
    const auto continued = [&](glm::ivec2 q, glm::ivec2 p) {
        const glm::vec3 last = values[indexOf(q)];
        const glm::ivec2 before = 2 * q - p;
        if (glm::any(glm::lessThan(before, glm::ivec2(0))) || glm::any(glm::greaterThanEqual(before, size)) ||
            !known[indexOf(before)] || chartOf(before) != chartOf(p) ||
            !belongTogether(atlas, points, indexOf(before), indexOf(q)))
            return last;
        // Clamped between none and twice the light: next to a shadow's edge the slope does not go on.
        return glm::clamp(2.0f * last - values[indexOf(before)], glm::vec3(0), 2.0f * last);
    };

    for (int ring = 0; !open.empty() && ring < kMaxRings; ++ring) {
        std::vector<glm::ivec2> still;
        std::vector<std::pair<size_t, glm::vec3>> filled;
        for (const glm::ivec2 p : open) {
            glm::vec3 sum(0);
            float count = 0;
            for (int i = 0; i < 9; ++i) {
                const glm::ivec2 q =
                    glm::clamp(p + glm::ivec2(i % 3 - 1, i / 3 - 1), glm::ivec2(0), size - 1);
                if (!known[indexOf(q)] || chartOf(q) != chartOf(p)) continue;
                if (!belongTogether(atlas, points, indexOf(q), indexOf(p))) continue;
                sum += ring == 0 ? continued(q, p) : values[indexOf(q)];
                count += 1;
            }
            if (count > 0)
                filled.emplace_back(indexOf(p), sum / count);
            else
                still.push_back(p);
        }
        if (filled.empty()) return;
        for (const auto& [index, value] : filled) {
            values[index] = value;
            known[index] = 1;
        }
        open.swap(still);
    }
}

}  // namespace phat
