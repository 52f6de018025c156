#pragma once
// Local linear regression [Cleveland 1979] of colours over the plane.

#include <cassert>

#include "core/base/math.h"

namespace phat {

/// A weighted plane through values, read at the origin.
class PlaneFit {
  public:
    /// `offset` in radii of the neighbourhood.
    void add(float weight, glm::vec2 offset, glm::vec3 value) {
        const float light = luminance(value);
        weights_ += weight;
        weightsSquared_ += weight * weight;
        lightSquared_ += weight * light * light;
        offset_ += weight * offset;
        xx_ += weight * offset.x * offset.x;
        xy_ += weight * offset.x * offset.y;
        yy_ += weight * offset.y * offset.y;
        value_ += weight * value;
        valueX_ += weight * offset.x * value;
        valueY_ += weight * offset.y * value;
        low_ = glm::min(low_, value);
        high_ = glm::max(high_, value);
    }
    bool empty() const { return weights_ <= 0.0f; }

    struct Estimate {
        glm::vec3 value;
        float residual;          // variance of the values' luminance that the plane leaves unexplained
        float varianceFraction;  // of the values' variance that is left in the estimate
    };
    /// pre: not empty().
    Estimate atOrigin() const {
        assert(!empty());
        const glm::vec2 m = offset_ / weights_;
        const glm::vec3 mean = value_ / weights_;
        const float xx = xx_ / weights_ - m.x * m.x + kRidge, yy = yy_ / weights_ - m.y * m.y + kRidge;
        const float xy = xy_ / weights_ - m.x * m.y;
        const glm::vec3 vx = valueX_ / weights_ - m.x * mean, vy = valueY_ / weights_ - m.y * mean;
        const float determinant = xx * yy - xy * xy;
        const glm::vec3 slopeX = (yy * vx - xy * vy) / determinant;
        const glm::vec3 slopeY = (xx * vy - xy * vx) / determinant;

        const float residual = lightSquared_ / weights_ - square(luminance(mean)) -
                               luminance(slopeX) * luminance(vx) - luminance(slopeY) * luminance(vy);
        const float leverage = 1.0f + (yy * m.x * m.x - 2.0f * xy * m.x * m.y + xx * m.y * m.y) / determinant;
        // Clamped to the range of the values: outside the nodes a plane extrapolates without bound.
        return {glm::clamp(mean - m.x * slopeX - m.y * slopeY, low_, high_), std::max(residual, 0.0f),
                leverage * weightsSquared_ / square(weights_)};
    }

  private:
    // Variance added to the offsets, of the squared radius: a handful of nodes in a row make no plane.
    static constexpr float kRidge = 0.01f;
    float weights_ = 0, weightsSquared_ = 0, lightSquared_ = 0, xx_ = 0, xy_ = 0, yy_ = 0;
    glm::vec2 offset_{0};
    glm::vec3 value_{0}, valueX_{0}, valueY_{0};
    glm::vec3 low_{1e30f}, high_{-1e30f};
};

}  // namespace phat
