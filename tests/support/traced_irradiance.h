#pragma once
// Irradiance by paths from a point.

#include <cmath>

#include "core/transport/path.h"

namespace phat::test {

/// Indirect irradiance at a point, the mean over `count` paths, and its standard error.
inline std::pair<double, double> tracedIrradiance(const RayScene& rays, const LightSampler& lights,
                                                  glm::vec3 position, glm::vec3 normal, int count,
                                                  int maxBounces = 12) {
    const Frame frame = frameFromNormal(normal);
    const glm::vec3 origin = rays.offsetOrigin(position, normal);
    Rng rng(7);
    double sum = 0, squares = 0;
    for (int i = 0; i < count; ++i) {
        const glm::vec2 square((float(i) + rng.uniform()) / float(count), rng.uniform());
        const glm::vec3 direction = glm::normalize(frame.toWorld(squareToCosineHemisphere(square)));
        const PathSettings path{.pathsPerHit = 1, .maxBounces = maxBounces};
        const double value =
            double(kPi) *
            luminance(traceIncident({rays, lights}, {origin, direction}, path, Rng(rng.bits())).reflected);
        sum += value;
        squares += value * value;
    }
    const double mean = sum / count;
    return {mean, std::sqrt(std::max(squares / count - mean * mean, 0.0) / count)};
}

}  // namespace phat::test
