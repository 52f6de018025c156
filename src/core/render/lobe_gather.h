#pragma once
// One lobe of a BRDF over the PHATexels around a point, sample by sample.

#include <array>
#include <cassert>

#include "core/render/phatexel_cloud.h"
#include "core/scene/brdf.h"

namespace phat {

/// A GGX lobe in scalars: the colour cancels in a ratio.
struct GatherLobe {
    glm::vec3 normal{0, 0, 1};     // world
    glm::vec3 towardEye{0, 0, 1};  // world
    float f0 = 0.04f;
    float f90 = 1;
    float alpha = 1;

    /// D V F cos, 1/sr; 0 when either direction is below the horizon.
    float value(glm::vec3 towardLight) const;
};

/// A PHATexel reconnected to another point.
struct ReconnectedPhatexel {
    glm::vec3 direction{0};
    float distance = 0;
    float jacobian = 1;  // of solid angles, there over here
};

/// Reconnection (Ouyang et al. 2021): the sample's end stays where it is.
ReconnectedPhatexel reconnect(const WorldPhatexel& phatexel, glm::vec3 to);
/// The sample unchanged, as if its hit were infinitely far away.
ReconnectedPhatexel unmoved(const WorldPhatexel& phatexel);

/// Distances around a point, by direction, from the PHATexels near it.
class LocalDepth {
  public:
    /// `unitMeters`: Atlas::unitMeters.
    LocalDepth(const Frame& frame, float unitMeters) : frame_(frame), unitMeters_(unitMeters) {}

    void add(glm::vec3 direction, float distance, float weight);
    /// Call between the last add() and the first visibility().
    void finish();
    /// Visibility of a point in a direction at a distance, 0 to 1: the fraction of the samples near that
    /// direction that are at least as long. Directions without samples are unoccluded.
    float visibility(glm::vec3 direction, float distance) const;

  private:
    static constexpr int kSize = 16;

    struct Look {
        int cell;
        float distance;
        float weight;  // after finish() with those of all before it in the cell
    };

    int cellOf(glm::vec3 direction) const;  // -1 below the horizon

    Frame frame_;
    float unitMeters_;
    std::vector<Look> looks_;                                  // by cell, the farthest first
    std::array<uint32_t, size_t(kSize) * kSize + 1> first_{};  // [cell] in looks_
};

/// Sums over a neighbourhood, weighted by its filter k; a = D V F cos J / p of each sample.
struct LobeSums {
    double k = 0;
    double a = 0;
    double aSquared = 0;
    double squaredWeights = 0;  // (k a)^2
    double nearness = 0;        // a / distance
    glm::dvec3 light{0};        // a L
    glm::dvec3 product{0};      // a a L

    void add(float weight, float value, const WorldPhatexel& phatexel, float distance);
    /// Of how many equal samples it would have the noise (Kish 1965).
    double effectiveSamples() const { return squaredWeights > 0 ? a * a / squaredWeights : 0; }
    /// Harmonic mean distance of the hits under the lobe, metres; 0 if there are none.
    float distance() const { return nearness > 0 ? float(a / nearness) : 0.0f; }
    /// Mean of the radiances, weighted by a. pre: a > 0.
    glm::vec3 mean() const {
        assert(a > 0);
        return glm::vec3(light / a);
    }
    /// The same where a's expectation is known to be `albedo`: the control variate that the samples
    /// themselves regress, between the plain mean of a L over the albedo and the ratio. pre: a > 0. source:
    /// Owen 2013, section 8.9.
    glm::vec3 regressed(float albedo) const;
};

}  // namespace phat
