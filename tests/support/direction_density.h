#pragma once
// Chi-squared of sampled directions against their density.

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/base/math.h"
#include "support/chi_squared.h"

namespace phat {

/// Compares how often directions fall into (z, azimuth) bins of the sphere with the integral of their
/// density. `sample()` returns a direction, or a zero vector for "no sample", whose chance is what the
/// density leaves below 1. A correct sampler fails once in 10,000 seeds.
template <typename Sample, typename Density>
void expectSamplesFollowDensity(const Sample& sample, const Density& density, int sampleCount = 200000) {
    constexpr int kRings = 24, kSectors = 48, kSub = 96;
    std::vector<double> expected(kRings * kSectors + 1, 0.0), observed(expected.size(), 0.0);
    double inside = 0;
    for (int ring = 0; ring < kRings; ++ring) {
        for (int sector = 0; sector < kSectors; ++sector) {
            double sum = 0;
            for (int i = 0; i < kSub * kSub; ++i) {
                const double z = -1 + 2 * (ring + (i / kSub + .5) / kSub) / kRings;
                const double phi = 2 * double(kPi) * (sector + (i % kSub + .5) / kSub) / kSectors;
                const double r = std::sqrt(std::max(0.0, 1 - z * z));
                sum += density(glm::vec3(r * std::cos(phi), r * std::sin(phi), z));
            }
            const double mean = sum / (kSub * kSub) * (4 * double(kPi) / (kRings * kSectors));
            expected[size_t(ring) * kSectors + sector] = mean * sampleCount;
            inside += mean;
        }
    }
    ASSERT_LT(inside, 1.01) << "the density integrates to more than 1";
    expected.back() = std::max(0.0, 1 - inside) * sampleCount;

    for (int i = 0; i < sampleCount; ++i) {
        const glm::vec3 d = sample();
        if (glm::dot(d, d) < 0.5f) {
            observed.back() += 1;
            continue;
        }
        const int ring = std::clamp(int((d.z + 1) * 0.5f * kRings), 0, kRings - 1);
        double phi = std::atan2(d.y, d.x);
        if (phi < 0) phi += 2 * double(kPi);
        const int sector = std::min(int(phi / (2 * double(kPi)) * kSectors), kSectors - 1);
        observed[size_t(ring) * kSectors + sector] += 1;
    }

    const test::ChiSquared result = test::chiSquared(observed, expected);
    ASSERT_GT(result.degreesOfFreedom, 0);
    EXPECT_LT(result.value, result.limit) << result.degreesOfFreedom << " degrees of freedom";
}

}  // namespace phat
