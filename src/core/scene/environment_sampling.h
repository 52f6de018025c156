#pragma once
// Importance sampling of a latitude-longitude environment.
//
// Radiance is bilinear between texel centres. A texel is chosen in proportion to the luminance that leaves
// it, the integral of the bilinear radiance over the texel's solid angle, and a direction uniformly inside,
// so that the pdf is chance / solid angle: exact, without a sin(theta), positive wherever there is light (bar
// texels below 1e-7 of their row's).

#include <vector>

#include "core/base/discrete_distribution.h"
#include "core/scene/scene.h"

namespace phat {

/// Bilinear lookup, azimuth repeated, poles clamped. pre: |direction| = 1, the picture is not empty.
glm::vec3 environmentRadiance(const Environment& environment, glm::vec3 direction);

/// The environment rotated about the vertical: column x becomes column x + `columns`, cyclically.
Environment turned(const Environment& environment, int columns);

struct EnvironmentSample {
    glm::vec3 direction{0, 1, 0};
    float pdf = 0;  // 1/sr
};

class EnvironmentDistribution {
  public:
    /// pre: the picture is not empty.
    explicit EnvironmentDistribution(const Environment& environment);

    /// Integral of radiance over the sphere, W/m2: the power on a unit of cross-section.
    glm::vec3 integratedRadiance() const { return integratedRadiance_; }
    /// Whether there is any light to sample.
    bool black() const { return !(rows_.total() > 0); }

    EnvironmentSample sample(glm::vec2 square) const;
    float pdf(glm::vec3 direction) const;

  private:
    float rowSolidAngle(int y) const;  // of one texel in row y

    int width_ = 0;
    int height_ = 0;
    DiscreteDistribution rows_;
    std::vector<float> cumulative_;  // [y][width + 1], each row from 0 to 1
    glm::vec3 integratedRadiance_{0};
};

}  // namespace phat
