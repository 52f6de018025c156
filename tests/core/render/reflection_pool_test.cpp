// Which neighbours' rays count for a lobe.

#include "core/render/reflection_pool.h"

#include <gtest/gtest.h>

namespace phat::test {
namespace {

constexpr int kSide = 9;
constexpr size_t kMiddle = kSide * kSide / 2;
constexpr float kStep = 0.01f;  // metres from pixel to pixel

/// A flat floor of one lobe, seen straight down.
std::vector<PooledLobe> flatFloor(float alpha, float distance) {
    std::vector<PooledLobe> lobes;
    for (uint32_t i = 0; i < kSide * kSide; ++i) {
        PooledLobe lobe;
        lobe.pixel = i;
        lobe.position = kStep * glm::vec3(float(i % kSide), 0, float(i / kSide));
        lobe.mirror = {0, 1, 0};
        lobe.alpha = alpha;
        lobe.distance = distance;
        lobes.push_back(lobe);
    }
    return lobes;
}

float raysForMiddle(std::vector<PooledLobe> lobes) {
    return ReflectionPool(std::move(lobes), kSide, kSide).raysForOne(kMiddle);
}

TEST(ReflectionPool, WhatIsFarIsTheSameForAllNeighbours) {
    const ReflectionPool pool(flatFloor(0.1f, 1e4f), kSide, kSide);
    EXPECT_NEAR(pool.raysForOne(kMiddle), 16, 1e-3f);     // a tent of 4 x 4
    EXPECT_NEAR(pool.raysForOne(0), 2.5f * 2.5f, 1e-3f);  // a quarter of it
}

TEST(ReflectionPool, WhatIsCloseStandsElsewhereForEach) {
    const float near = raysForMiddle(flatFloor(0.1f, 0.02f)), middle = raysForMiddle(flatFloor(0.1f, 0.2f));
    EXPECT_NEAR(near, 1, 0.01f);  // half a radian from pixel to pixel
    EXPECT_GT(middle, 4);
    EXPECT_LT(middle, 15);
}

// Mirrors that look at one point, as a hollow one does.
TEST(ReflectionPool, TurnAndStepMayCancel) {
    constexpr float kDistance = 1;
    std::vector<PooledLobe> lobes = flatFloor(0.02f, kDistance);
    const glm::vec3 point = lobes[kMiddle].position + glm::vec3(0, kDistance, 0);
    for (PooledLobe& lobe : lobes) lobe.mirror = glm::normalize(point - lobe.position);
    EXPECT_NEAR(raysForMiddle(lobes), 16, 0.1f);
}

TEST(ReflectionPool, OtherSurfacesAndOtherLobesDoNotCount) {
    const auto changed = [](const auto& change) {
        std::vector<PooledLobe> lobes = flatFloor(0.1f, 1e4f);
        for (size_t i = 0; i < lobes.size(); ++i)
            if (i != kMiddle) change(lobes[i]);
        return raysForMiddle(std::move(lobes));
    };
    EXPECT_EQ(changed([](PooledLobe& lobe) { lobe.side = 1; }), 1);
    EXPECT_EQ(changed([](PooledLobe& lobe) { lobe.alpha = 0; }), 1);
    EXPECT_EQ(changed([](PooledLobe& lobe) { lobe.alpha = 0.2f; }), 1);
    EXPECT_GT(changed([](PooledLobe& lobe) { lobe.alpha = 0.11f; }), 15);
    EXPECT_LT(changed([](PooledLobe& lobe) { lobe.mirror = glm::vec3(0.6f, 0.8f, 0); }), 1.001f);
}

// At 60 degrees a lobe is half as wide from side to side as it is toward the eye and away from it.
TEST(ReflectionPool, GrazingLobesAreNarrowAside) {
    const auto turned = [](glm::vec3 change) {
        std::vector<PooledLobe> lobes = flatFloor(0.02f, 1e4f);
        for (size_t i = 0; i < lobes.size(); ++i) {
            lobes[i].towardEye = {0, 0.5f, -std::sqrt(0.75f)};
            lobes[i].mirror = {0, 0.5f, std::sqrt(0.75f)};
            if (i != kMiddle) lobes[i].mirror += change;
        }
        return raysForMiddle(std::move(lobes));
    };
    constexpr float kTurn = 0.016f;  // the pool's width
    const float upward = turned(kTurn * glm::vec3(0, std::sqrt(0.75f), -0.5f)), aside = turned({kTurn, 0, 0});
    EXPECT_NEAR(upward, 1 + 15 * std::exp(-0.5f), 0.01f);
    EXPECT_NEAR(aside, 1 + 15 * std::exp(-2.0f), 0.02f);
    EXPECT_NEAR(turned({kTurn / 2, 0, 0}), upward, 0.02f);
}

TEST(ReflectionPool, MirrorsKeepToTheirOwnRays) {
    EXPECT_EQ(raysForMiddle(flatFloor(1e-3f, 1e4f)), 1);
}

TEST(ReflectionPool, StepsLeadToTheNextPixelOfTheSide) {
    std::vector<PooledLobe> lobes = flatFloor(0.1f, 1);
    lobes[kMiddle + 1].mirror = {0.6f, 0.8f, 0};
    lobes[kMiddle + kSide].side = 1;  // below is another surface: the one above counts
    lobes[0].side = 2;
    const ReflectionPool pool(std::move(lobes), kSide, kSide);
    const ReflectionPool::Steps steps = pool.steps(kMiddle), none = pool.steps(0);
    EXPECT_NEAR(steps.position[0].x, kStep, 1e-6f);
    EXPECT_NEAR(steps.mirror[0].x, 0.6f, 1e-6f);
    EXPECT_NEAR(steps.position[1].z, -kStep, 1e-6f);
    EXPECT_EQ(steps.mirror[1], glm::vec3(0));
    EXPECT_EQ(none.position[0], glm::vec3(0));
    EXPECT_EQ(none.mirror[1], glm::vec3(0));
}

/// What all see by the pool where all rays brought 1 but for the middle's.
std::vector<glm::vec3> pooledAround(float middle, float distance) {
    const ReflectionPool pool(flatFloor(0.1f, distance), kSide, kSide);
    std::vector<PooledLight> lights(kSide * kSide, {glm::vec3(1), glm::vec3(2), 4});
    lights[kMiddle].indirect = glm::vec3(middle);
    std::vector<ReflectionPool::Redistribution> redistributions;
    for (size_t i = 0; i < lights.size(); ++i) redistributions.push_back(pool.redistribute(i, lights));
    std::vector<glm::vec3> pooled;
    for (size_t i = 0; i < lights.size(); ++i) {
        const PooledLight light = pool.pooled(i, lights, redistributions);
        pooled.push_back(light.indirect);
        EXPECT_NEAR(light.area.x, 2, 1e-4f);
    }
    return pooled;
}

TEST(ReflectionPool, IsTheMeanOfWhatItsNeighboursSee) {
    const auto pooled = pooledAround(3, 1e4f);
    EXPECT_NEAR(pooled[kMiddle].x, (240 + 16 * 3) / 256.0f, 1e-3f);
    EXPECT_NEAR(pooled[kMiddle + 3].x, (252 + 4 * 3) / 256.0f,
                0.02f);  // its neighbourhood ends at the border
    EXPECT_NEAR(pooled[kMiddle + 4].x, 1, 1e-3f);
}

TEST(ReflectionPool, WhatIsCloseIsEachPixelsOwn) {
    EXPECT_NEAR(pooledAround(3, 0.005f)[kMiddle].x, 3, 1e-3f);
}

// 8 is 4 more than four times what is around: those go to all by the tent, 1/256 each.
TEST(ReflectionPool, SpotsAreSharedOut) {
    const auto pooled = pooledAround(8, 0.005f);
    EXPECT_NEAR(pooled[kMiddle].x, 4 + 4 * 16 / 256.0f, 1e-3f);
    EXPECT_NEAR(pooled[kMiddle + 1].x, 1 + 4 * 12 / 256.0f, 1e-3f);
    float sum = 0;
    for (const glm::vec3& light : pooled) sum += light.x;
    EXPECT_NEAR(sum, kSide * kSide - 1 + 8, 0.01f);
}

TEST(ReflectionPool, NoSpotShowsWhereItWasSharedOut) {
    const auto pooled = pooledAround(1e6f, 0.005f);
    EXPECT_NEAR(pooled[kMiddle].x, 5, 1e-3f);
    EXPECT_NEAR(pooled[kMiddle + 1].x, 1 + 12 / 16.0f, 1e-3f);
    EXPECT_NEAR(pooled[kMiddle + 4].x, 1, 1e-3f);
}

}  // namespace
}  // namespace phat::test
