#include "core/render/lobe_gather.h"

#include <gtest/gtest.h>

#include "core/base/random.h"

namespace phat {
namespace {

const glm::vec3 kUp(0, 1, 0);

WorldPhatexel phatexelAt(glm::vec3 origin, glm::vec3 end, glm::vec3 radiance = glm::vec3(1)) {
    return {origin, 1.0f, end, glm::distance(origin, end), radiance};
}

TEST(LobeGather, LobeIsTheBrdfsSpecularPart) {
    Brdf brdf;
    brdf.f0 = glm::vec3(0.3f);
    brdf.alpha = 0.2f;
    const GatherLobe lobe{{0, 0, 1}, glm::normalize(glm::vec3(0.6f, -0.2f, 0.5f)), 0.3f, 1, 0.2f};
    Rng rng(1);
    for (int i = 0; i < 100; ++i) {
        const float z = rng.uniform(), phi = 2 * kPi * rng.uniform(), r = std::sqrt(1 - z * z);
        const glm::vec3 towardLight(r * std::cos(phi), r * std::sin(phi), z);
        const float expected = evaluateLobes(brdf, lobe.towardEye, towardLight).specular.x;
        EXPECT_NEAR(lobe.value(towardLight), expected, 1e-4f * expected);
    }
    EXPECT_EQ(lobe.value({0, 0.6f, -0.8f}), 0);
}

TEST(LobeGather, ReconnectionKeepsTheEnd) {
    const WorldPhatexel phatexel = phatexelAt({0, 0, 0}, {0, 2, 0});
    const ReconnectedPhatexel moved = reconnect(phatexel, {1.5f, 0, 0});
    EXPECT_NEAR(moved.distance, 2.5f, 1e-6f);
    EXPECT_LT(glm::distance(moved.direction, glm::vec3(-0.6f, 0.8f, 0)), 1e-6f);
    EXPECT_NEAR(moved.jacobian, (2.0f * 2.0f) / (2.5f * 2.5f), 1e-6f);

    const ReconnectedPhatexel same = reconnect(phatexel, {0, 0, 0});
    EXPECT_EQ(same.direction, kUp);
    EXPECT_EQ(same.jacobian, 1);
    EXPECT_EQ(unmoved(phatexel).direction, kUp);
    EXPECT_EQ(unmoved(phatexel).distance, 2);

    EXPECT_EQ(reconnect(phatexel, {0, 1.99f, 0}).jacobian, 4) << "held";
    EXPECT_EQ(reconnect(phatexel, {0, 2, 0}).jacobian, 1) << "at the end itself there is no direction";
}

TEST(LobeGather, LightFromInfinityStays) {
    const WorldPhatexel sky{{0, 0, 0}, 1, {0.6f, 0.8f, 0}, kFarDistance, glm::vec3(1)};
    const ReconnectedPhatexel moved = reconnect(sky, {5, 0, 7});
    EXPECT_EQ(moved.direction, sky.end);
    EXPECT_EQ(moved.distance, kFarDistance);
    EXPECT_EQ(moved.jacobian, 1);
}

TEST(LobeGather, DepthIsAVoteOfTheNeighbors) {
    LocalDepth depth(frameFromNormal(kUp), 1);
    const glm::vec3 half = glm::normalize(glm::vec3(0.5f, 1, 0)),
                    unknown = glm::normalize(glm::vec3(-2, 1, 0));
    depth.add(kUp, 1, 0.5f);
    depth.add(half, 1, 3);
    depth.add(half, 10, 1);
    depth.add(-kUp, 0.1f, 1);
    depth.finish();
    EXPECT_EQ(depth.visibility(kUp, 1.2f), 1);
    EXPECT_EQ(depth.visibility(kUp, 1.4f), 0);
    EXPECT_EQ(depth.visibility(half, 0.5f), 1);
    EXPECT_EQ(depth.visibility(half, 5), 0.25f);
    EXPECT_EQ(depth.visibility(half, kFarDistance), 0);
    EXPECT_EQ(depth.visibility(unknown, 1e6f), 1);
    EXPECT_EQ(depth.visibility(-kUp, 1e6f), 1);
}

TEST(LobeGather, EffectiveSamplesAndDistance) {
    LobeSums sums;
    EXPECT_EQ(sums.effectiveSamples(), 0);
    EXPECT_EQ(sums.distance(), 0);
    for (int i = 0; i < 5; ++i) sums.add(0.5f, 2, phatexelAt({0, 0, 0}, kUp), i < 4 ? 1.0f : 0.25f);
    EXPECT_NEAR(sums.effectiveSamples(), 5, 1e-9);
    EXPECT_NEAR(sums.distance(), 5.0f / 8.0f, 1e-6f);
    sums.add(1, 1e-9f, phatexelAt({0, 0, 0}, kUp), 1);
    EXPECT_NEAR(sums.effectiveSamples(), 5, 1e-6);
}

// Constant light is exact whatever the samples' weights.
TEST(LobeGather, ConstantLightIsExact) {
    LobeSums sums;
    Rng rng(3);
    for (int i = 0; i < 50; ++i)
        sums.add(rng.uniform(), 10 * rng.uniform(), phatexelAt({0, 0, 0}, kUp, {1, 2, 3}), 1);
    EXPECT_LT(glm::distance(sums.mean(), glm::vec3(1, 2, 3)), 1e-5f);
    EXPECT_LT(glm::distance(sums.regressed(0.7f), glm::vec3(1, 2, 3)), 1e-5f);
}

// Light in a few directions only, found by samples whose p follows it: a L is always the same, a is not.
TEST(LobeGather, RegressionIsThePlainMeanWhereDensityFollowsLight) {
    LobeSums sums;
    Rng rng(4);
    for (int i = 0; i < 20'000; ++i) {
        // Half of the samples see the lamp (a = .2, L = 5), the others darkness with a of 0 to 3.6: mean a
        // is 1.
        const bool lamp = i % 2 == 0;
        sums.add(1, lamp ? 0.2f : 3.6f * rng.uniform(), phatexelAt({0, 0, 0}, kUp, glm::vec3(lamp ? 5 : 0)),
                 1);
    }
    // Known albedo 1: the light is .5; a wrong albedo shows which of both it follows.
    EXPECT_NEAR(sums.regressed(1).x, 0.5f, 0.005f);
    EXPECT_NEAR(sums.regressed(0.5f).x, 1.0f, 0.01f);
    EXPECT_NEAR(sums.mean().x, 0.5f, 0.01f) << "the ratio does not look at the albedo";
}

}  // namespace
}  // namespace phat
