#pragma once
// What a lamp was measured to emit in every direction.

#include <glm/glm.hpp>
#include <string>
#include <vector>

namespace phat {

/// Intensity over directions, linear in both angles between the points of a regular grid. The vertical angle
/// is 0 in the direction that the lamp points in and 180 degrees behind it; horizontal angles grow around
/// that axis.
struct PhotometricWeb {
    std::string name;             // of the file or of the light profile
    float peakCandela = 0;        // the largest of all
    int verticalSteps = 1;        // over half a turn
    int horizontalSteps = 1;      // over a whole one; 1: the same all around
    std::vector<float> relative;  // [horizontalSteps][verticalSteps + 1], intensity over the peak's
};

/// A web that light is evaluated and sampled by. Directions leave the lamp and are in its node's space, as
/// EXT_lights_ies has it: vertical angle 0 is -z, horizontal angle 0 is +x and 90 degrees +y.
class Photometry {
  public:
    /// pre: the grid is complete, in 0 to 1, and not all of it is 0.
    explicit Photometry(PhotometricWeb web);

    const PhotometricWeb& web() const { return web_; }

    /// Intensity over the peak's, 0 to 1. pre: |direction| = 1.
    float at(glm::vec3 direction) const;
    /// Integral of `at` over the sphere, sr: the flux of a lamp whose peak is 1.
    float solidAngle() const { return solidAngle_; }
    /// A direction of density `at` / `solidAngle`.
    glm::vec3 sample(glm::vec2 square) const;

    float lumens() const { return web_.peakCandela * solidAngle_; }
    /// Directions at a smaller cosine from -z are dark.
    float darkBelowCosine() const { return darkBelowCosine_; }
    /// In the plane through the axis and a horizontal angle: the angle between the outermost directions on
    /// both sides that have at least `fraction` of the peak.
    float spreadDegrees(float horizontalDegrees, float fraction) const;

  private:
    float point(int horizontal, int vertical) const {
        return web_.relative[size_t(horizontal) * (web_.verticalSteps + 1) + vertical];
    }
    const double* cumulated(int horizontal) const {
        return &cumulative_[size_t(horizontal) * (web_.verticalSteps + 1)];
    }
    double columnOf(int horizontal) const { return cumulated(horizontal)[web_.verticalSteps]; }

    PhotometricWeb web_;
    std::vector<double> cumulative_;  // [h][v]: integral of column h over its first v steps, times sine
    std::vector<double> turned_;      // [horizontalSteps + 1]: of the mean of neighbouring columns
    float solidAngle_ = 0;
    float darkBelowCosine_ = -1;
};

}  // namespace phat
