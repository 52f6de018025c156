#pragma once
// Which of the pieces of a cut triangle are near a point or a line.

#include <algorithm>
#include <cstdint>
#include <vector>

#include "core/base/math.h"

namespace phat {

/// A grid over a triangle's plane. Pieces are found by the cells that their bounds touched when they were
/// added, so that those that have become smaller since may be found too often.
class TriangleGrid {
  public:
    /// pre: the normal is unit, the triangle has an area.
    TriangleGrid(const glm::dvec3 (&corners)[3], glm::dvec3 normal)
        : origin_(corners[0]),
          x_(glm::normalize(corners[1] - corners[0])),
          y_(glm::cross(normal, x_)),
          cells_(size_t(kSide) * kSide) {
        glm::dvec2 high(0);
        for (const glm::dvec3& corner : corners) {
            low_ = glm::min(low_, inPlane(corner));
            high = glm::max(high, inPlane(corner));
        }
        cell_ = (high - low_) / double(kSide);
    }

    void add(uint32_t piece, const glm::dvec3 (&corners)[3]) {
        glm::ivec2 low(kSide), high(-1);
        for (const glm::dvec3& corner : corners) {
            low = glm::min(low, cellOf(inPlane(corner)));
            high = glm::max(high, cellOf(inPlane(corner)));
        }
        for (int y = low.y; y <= high.y; ++y)
            for (int x = low.x; x <= high.x; ++x) cells_[size_t(y) * kSide + size_t(x)].push_back(piece);
    }

    /// Pieces within `margin` of a segment, ascending, and others.
    std::vector<uint32_t> near(glm::dvec3 from, glm::dvec3 to, double margin) const {
        glm::dvec2 a = inPlane(from), b = inPlane(to);
        if (a.x > b.x) std::swap(a, b);
        std::vector<uint32_t> found;
        const int first = cellOf(a - margin).x, last = cellOf(b + margin).x;
        for (int x = first; x <= last; ++x) {
            // The part of the segment in this column.
            const double left = low_.x + x * cell_.x, right = left + cell_.x;
            const double length = std::max(b.x - a.x, 1e-300);
            const double s = glm::clamp((left - margin - a.x) / length, 0.0, 1.0),
                         t = glm::clamp((right + margin - a.x) / length, 0.0, 1.0);
            const double y0 = glm::mix(a.y, b.y, x == first ? 0.0 : s),
                         y1 = glm::mix(a.y, b.y, x == last ? 1.0 : t);
            const int low = cellOf(glm::dvec2(left, std::min(y0, y1) - margin)).y,
                      high = cellOf(glm::dvec2(left, std::max(y0, y1) + margin)).y;
            for (int y = low; y <= high; ++y) {
                const auto& cell = cells_[size_t(y) * kSide + size_t(x)];
                found.insert(found.end(), cell.begin(), cell.end());
            }
        }
        std::sort(found.begin(), found.end());
        found.erase(std::unique(found.begin(), found.end()), found.end());
        return found;
    }

  private:
    static constexpr int kSide = 16;

    glm::dvec2 inPlane(glm::dvec3 point) const {
        return {glm::dot(point - origin_, x_), glm::dot(point - origin_, y_)};
    }
    glm::ivec2 cellOf(glm::dvec2 point) const {
        return glm::clamp(glm::ivec2(glm::floor(glm::clamp((point - low_) / cell_, -1.0, double(kSide)))),
                          glm::ivec2(0), glm::ivec2(kSide - 1));
    }

    glm::dvec3 origin_, x_, y_;
    glm::dvec2 low_{0}, cell_{1};
    std::vector<std::vector<uint32_t>> cells_;
};

}  // namespace phat
