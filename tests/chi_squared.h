#pragma once
// Chi-squared against a density: the test of every sampler.

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/math.h"

namespace phat {

/// Chance that a chi-squared variable of `freedom` degrees exceeds `value`; Wilson and Hilferty 1931.
inline double chiSquaredTail(double value, double freedom) {
    const double t = (std::cbrt(value / freedom) - (1 - 2 / (9 * freedom))) / std::sqrt(2 / (9 * freedom));
    return 0.5 * std::erfc(t / std::sqrt(2.0));
}

/// Compares how often directions fall into (z, azimuth) bins of the sphere with the integral of their density.
/// `sample()` returns a direction, or a zero vector for "no sample", whose chance is what the density leaves
/// below 1. Bins that expect fewer than 5 are pooled. `level`: the family-wise chance of a false alarm.
template <typename Sample, typename Density>
void expectSamplesFollowDensity(const Sample& sample, const Density& density, int sampleCount = 200000,
                                double level = 1e-4) {
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

    double chiSquared = 0, pooledExpected = 0, pooledObserved = 0;
    int bins = 0;
    for (size_t i = 0; i < expected.size(); ++i) {
        if (expected[i] < 5) {
            pooledExpected += expected[i];
            pooledObserved += observed[i];
            continue;
        }
        chiSquared += (observed[i] - expected[i]) * (observed[i] - expected[i]) / expected[i];
        ++bins;
    }
    if (pooledExpected >= 5) {
        chiSquared += (pooledObserved - pooledExpected) * (pooledObserved - pooledExpected) / pooledExpected;
        ++bins;
    } else {
        EXPECT_LT(pooledObserved, 30) << "samples where the density is nearly zero";
    }
    ASSERT_GT(bins, 1);
    EXPECT_GT(chiSquaredTail(chiSquared, bins - 1), level) << "chi-squared " << chiSquared << " in " << bins << " bins";
}

}  // namespace phat
