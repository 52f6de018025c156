#pragma once

#include <array>
#include <vector>

#include "core/base/math.h"
#include "core/base/random.h"

namespace phat {

struct AreaPoint {
    glm::dvec3 position{0};
    uint64_t seed = 0;  // of its own
};

/// Points that are equally spaced over the area of triangles, which are visited one after another; within its
/// triangle, a point is anywhere.
class AreaPoints {
  public:
    AreaPoints(int count, double totalArea) : count_(count), totalArea_(totalArea) {}

    /// Those on the next triangle. `seed`: what it is for, and the triangle's number.
    std::vector<AreaPoint> next(const std::array<glm::dvec3, 3>& corners, glm::uvec2 seed) {
        const auto& [p0, p1, p2] = corners;
        passed_ += 0.5 * glm::length(glm::cross(p1 - p0, p2 - p0));
        std::vector<AreaPoint> points;
        for (; point_ < count_ && (point_ + 0.5) * totalArea_ <= passed_ * count_; ++point_) {
            const uint64_t own = hashOf(seed.x, seed.y, uint64_t(point_));
            glm::dvec2 b = Rng(own).uniform2();
            if (b.x + b.y > 1) b = 1.0 - b;
            points.push_back({(1 - b.x - b.y) * p0 + b.x * p1 + b.y * p2, own});
        }
        return points;
    }

    /// How many there were so far.
    int visited() const { return point_; }

  private:
    int count_;
    double totalArea_;
    double passed_ = 0;
    int point_ = 0;
};

}  // namespace phat
