#include "core/phatexel/phatexture.h"

#include <gtest/gtest.h>

#include "core/base/random.h"
#include "core/phatexel/direction_cells.h"

namespace phat {
namespace {

glm::vec3 randomDirection(Rng& rng) {
    return squareToHemisphere(rng.uniform2());
}

TEST(PhatexelPacking, RadianceKeepsItsLargestChannelTo9Bits) {
    Rng rng(1);
    for (int i = 0; i < 200000; ++i) {
        const float scale = std::exp2(24 * rng.uniform() - 10);
        const glm::vec3 rgb = scale * glm::vec3(rng.uniform(), rng.uniform(), rng.uniform());
        if (maxComponent(rgb) > 65000.0f) continue;
        const glm::vec3 error = glm::abs(unpackRgb9e5(packRgb9e5(rgb)) - rgb);
        ASSERT_LE(maxComponent(error), maxComponent(rgb) / 511.0f) << rgb.x << ' ' << rgb.y << ' ' << rgb.z;
    }
}

TEST(PhatexelPacking, RadianceClampsWhatItCannotHold) {
    EXPECT_EQ(unpackRgb9e5(packRgb9e5({1e9f, -1, NAN})), glm::vec3(65408, 0, 0));
    EXPECT_EQ(unpackRgb9e5(packRgb9e5(glm::vec3(0))), glm::vec3(0));
    EXPECT_EQ(unpackRgb9e5(packRgb9e5(glm::vec3(1))), glm::vec3(1));
}

TEST(PhatexelPacking, DirectionsComeBackWithin006Degrees) {
    Rng rng(2);
    float worst = 0;
    for (int i = 0; i < 200000; ++i) {
        glm::vec3 d = randomDirection(rng);
        if (i & 1) d.z = -d.z;
        const glm::vec3 back = unpackOctahedral24(packOctahedral24(d));
        ASSERT_NEAR(glm::length(back), 1, 1e-5f);
        worst = std::max(worst, glm::length(glm::cross(d, back)));
    }
    EXPECT_LT(glm::degrees(worst), 0.06f);
}

TEST(PhatexelPacking, DistanceStepsAreEqualRatios) {
    const float halfStep = std::exp2(0.5f * 19.931569f / 253);
    for (const float unit : {1.0f, 1.7e3f, 0.9e-3f}) {
        for (float d = 1.001e-3f * unit; d < 999 * unit; d *= 1.01f) {
            const float back = unpackDistance(packDistance(d, unit), unit);
            ASSERT_LT(std::max(back / d, d / back), halfStep * 1.0001f) << d << " in units of " << unit;
        }
        EXPECT_EQ(packDistance(1e-9f * unit, unit), 1u);
        EXPECT_EQ(packDistance(5000 * unit, unit), 254u);
        EXPECT_EQ(packDistance(kFarDistance, unit), 255u);
        EXPECT_EQ(unpackDistance(255, unit), kFarDistance);
    }
}

TEST(PhatexelPacking, InvalidIsAllZero) {
    const PackedPhatexel packed = packPhatexel({}, 1);
    EXPECT_EQ(packed.radiance, 0u);
    EXPECT_EQ(packed.directionDistance, 0u);
    EXPECT_FALSE(unpackPhatexel(packed, 1).valid);
    EXPECT_FALSE(unpackPhatexel16(packPhatexel16({})).valid);
}

float radiansBetween(glm::vec3 a, glm::vec3 b) {
    return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

// The last place of halves is 2^-10 for 1 to 2 radians and 2^-9 for 2 to 4: theta is within 2^-11 and phi
// within 2^-10 of the nearest, and within three times as much of the one beside it.
TEST(PhatexelPacking, ThePapersAnglesAreWithinAHalfsLastPlace) {
    const float nearest = std::hypot(0x1p-11f, 0x1p-10f), beside = 3 * nearest, rounding = 1e-6f;
    Rng rng(6);
    int further = 0;
    constexpr int kCount = 200'000;
    for (int i = 0; i < kCount; ++i) {
        // Every fourth near the pole, every fourth near the horizon.
        glm::vec2 square = rng.uniform2();
        if (i % 4 == 0) square = 0.5f + 0.01f * (square - 0.5f);
        if (i % 4 == 1) square.x *= 1e-4f;
        const glm::vec3 d = storableDirection(squareToHemisphere(square));
        const Phatexel back = unpackPhatexel16(packPhatexel16({glm::vec3(7, 1e5f, 1e-5f), d, 3, 1, true}));
        ASSERT_EQ(back.radiance, glm::vec3(7, 1e5f, 1e-5f));
        ASSERT_EQ(back.distance, kFarDistance);
        ASSERT_GE(back.directionBlock.z, 0);
        const float error = radiansBetween(d, back.directionBlock);
        ASSERT_LE(error, beside + rounding) << d.x << ' ' << d.y << ' ' << d.z;
        further += error > nearest + rounding;
    }
    // Those whose nearest halves lie in another cell.
    EXPECT_LT(further, kCount / 50);
}

// A neighbour's density may be a hundred times less.
TEST(PhatexelPacking, ThePapersAnglesKeepTheDensityOfEveryStorableDirection) {
    Rng rng(7);
    std::array<float, kGuideCells> cells{};
    for (float& cell : cells) cell = std::exp2(8 * rng.uniform());
    const Guide guide = makeGuide(cells, 0.1f);
    for (uint32_t code = 0; code < 1u << 24; code += 1 + rng.bits() % 16) {
        glm::vec3 d = unpackOctahedral24(code);
        if (d.z < 0) continue;
        d = storableDirection(d);
        const Phatexel back = unpackPhatexel16(packPhatexel16({glm::vec3(1), d, 3, 1, true}));
        ASSERT_EQ(squareToGuidePdf(guide, back.directionBlock), squareToGuidePdf(guide, d)) << code;
    }
}

// What a filter makes of many PHATexels hardly notices either storage: mean of L cos / p over guided samples.
TEST(PhatexelPacking, BothStoragesKeepAnEstimateWithinHalfAPercent) {
    Rng rng(3);
    std::array<float, kGuideCells> cells{};
    for (float& cell : cells) cell = rng.uniform();
    const Guide guide = makeGuide(cells, 0.3f);
    double exact = 0, packed8 = 0, packed16 = 0;
    for (int i = 0; i < 20000; ++i) {
        const glm::vec3 d = squareToGuide(guide, rng.uniform2());
        const Phatexel phatexel{glm::vec3(2 + d.x, 1, 0.1f), d, 1 + rng.uniform(), squareToGuidePdf(guide, d),
                                true};
        exact += phatexel.radiance.x * d.z / phatexel.pdf;
        Phatexel back = unpackPhatexel(packPhatexel(phatexel, 1), 1);
        packed8 += back.radiance.x * back.directionBlock.z / squareToGuidePdf(guide, back.directionBlock);
        back = unpackPhatexel16(packPhatexel16(phatexel));
        packed16 += back.radiance.x * back.directionBlock.z / squareToGuidePdf(guide, back.directionBlock);
    }
    EXPECT_NEAR(packed8 / exact, 1, 0.005);
    EXPECT_NEAR(packed16 / exact, 1, 0.005);
}

TEST(Guide, WeightsSumToTheTotalAndNoneIsZero) {
    Rng rng(4);
    for (int trial = 0; trial < 200; ++trial) {
        std::array<float, kGuideCells> cells{};
        const int lit = 1 + int(rng.uniform() * 255);
        for (int i = 0; i < lit; ++i) cells[rng.bits() % kGuideCells] += std::exp2(20 * rng.uniform());
        const Guide guide = makeGuide(cells, trial % 2 ? 0.3f : 0.0f);
        uint32_t total = 0;
        for (uint16_t weight : guide.weight) {
            ASSERT_GE(weight, 1);
            total += weight;
        }
        ASSERT_EQ(total, kGuideTotal);
    }
}

TEST(Guide, NothingKnownIsUniform) {
    EXPECT_EQ(makeGuide({}, 0.3f).weight, uniformGuide().weight);
    EXPECT_NEAR(squareToGuidePdf(uniformGuide(), {0, 0, 1}), 1 / (2 * kPi), 1e-7f);
}

TEST(Guide, SquareAndDirectionAreInverse) {
    Rng rng(5);
    std::array<float, kGuideCells> cells{};
    for (float& cell : cells) cell = std::exp2(6 * rng.uniform());
    const Guide guide = makeGuide(cells, 0.1f);
    for (int i = 0; i < 20000; ++i) {
        const glm::vec2 square = rng.uniform2();
        const glm::vec2 back = guideToSquare(guide, squareToGuide(guide, square));
        ASSERT_LT(glm::distance(square, back), 5e-3f) << square.x << ' ' << square.y;
    }
}

}  // namespace
}  // namespace phat
