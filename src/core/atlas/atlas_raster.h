#pragma once
// Triangles over texel centres.

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/math.h"

namespace phat {

/// Twice the signed area of (a, b, p), exactly antisymmetric in a and b: two triangles that share an edge see
/// the same number with opposite signs, so that no centre between them is lost or claimed twice.
inline double edgeFunction(glm::vec2 a, glm::vec2 b, glm::dvec2 p) {
    const bool ordered = a.x < b.x || (a.x == b.x && a.y < b.y);
    const glm::dvec2 from = ordered ? a : b, to = ordered ? b : a;
    const double value = (to.x - from.x) * (p.y - from.y) - (to.y - from.y) * (p.x - from.x);
    return ordered ? value : -value;
}

/// Calls visit(x, y) for every texel centre (x + .5, y + .5) with 0 <= x < width, 0 <= y < height inside a
/// counter-clockwise triangle. Centres on an edge belong to the side that the edge's direction picks (the
/// top-left rule); clockwise triangles have none.
template <class Visit>
void forEachTexel(const std::array<glm::vec2, 3>& corner, int width, int height, Visit&& visit) {
    const glm::vec2 low = glm::min(corner[0], glm::min(corner[1], corner[2]));
    const glm::vec2 high = glm::max(corner[0], glm::max(corner[1], corner[2]));
    if (!(edgeFunction(corner[0], corner[1], corner[2]) > 0)) return;
    const int x0 = std::max(0, int(std::floor(low.x - 0.5f))),
              x1 = std::min(width - 1, int(std::ceil(high.x)));
    const int y0 = std::max(0, int(std::floor(low.y - 0.5f))),
              y1 = std::min(height - 1, int(std::ceil(high.y)));
    const auto inside = [&](int i, glm::dvec2 p) {
        const glm::vec2 a = corner[i], b = corner[(i + 1) % 3];
        const double side = edgeFunction(a, b, p);
        if (side != 0) return side > 0;
        return b.y < a.y || (b.y == a.y && b.x > a.x);
    };
    for (int y = y0; y <= y1; ++y) {
        for (int x = x0; x <= x1; ++x) {
            const glm::dvec2 p(x + 0.5, y + 0.5);
            if (inside(0, p) && inside(1, p) && inside(2, p)) visit(x, y);
        }
    }
}

}  // namespace phat
