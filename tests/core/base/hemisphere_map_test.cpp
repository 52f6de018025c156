#include "core/base/hemisphere_map.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>

namespace phat {
namespace {

TEST(HemisphereMap, InverseReturnsTheSquarePoint) {
    std::mt19937 random(1);
    std::uniform_real_distribution<float> unit(0.0f, 1.0f);
    for (int i = 0; i < 100000; ++i) {
        const glm::vec2 square(unit(random), unit(random));
        const glm::vec3 direction = squareToHemisphere(square);
        ASSERT_NEAR(glm::length(direction), 1.0f, 1e-6f);
        ASSERT_GE(direction.z, 0.0f);
        ASSERT_LT(glm::distance(hemisphereToSquare(direction), square), 2e-4f) << square.x << ' ' << square.y;
    }
}

// Uniform points must land in equal-solid-angle bins (z, azimuth) uniformly.
// 32 bins, 31 degrees of freedom: a correct map exceeds 61.1 once in 1000 seeds.
TEST(HemisphereMap, IsEqualArea) {
    constexpr int kRings = 4, kSectors = 8, kSamples = 320000;
    std::array<int, kRings * kSectors> counts{};
    std::mt19937 random(7);
    std::uniform_real_distribution<float> unit(0.0f, 1.0f);
    for (int i = 0; i < kSamples; ++i) {
        const glm::vec3 d = squareToHemisphere({unit(random), unit(random)});
        const int ring = std::min(kRings - 1, int(d.z * kRings));
        const int sector = std::min(kSectors - 1, int((std::atan2(d.y, d.x) / (2 * kPi) + 0.5f) * kSectors));
        ++counts[ring * kSectors + sector];
    }
    const double expected = double(kSamples) / counts.size();
    double chiSquared = 0;
    for (int count : counts) chiSquared += (count - expected) * (count - expected) / expected;
    EXPECT_LT(chiSquared, 61.1);
}

TEST(HemisphereMap, PdfIntegratesToOne) {
    EXPECT_FLOAT_EQ(squareToHemispherePdf({0, 0, 1}) * 2 * kPi, 1.0f);
    EXPECT_EQ(squareToHemispherePdf({0, 0, -1}), 0.0f);
}

}  // namespace
}  // namespace phat
