// Which neighbours' rays count for a lobe.

#include "core/reflection_pool.h"

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

TEST(ReflectionPool, MirrorsKeepToTheirOwnRays) {
    EXPECT_EQ(raysForMiddle(flatFloor(1e-3f, 1e4f)), 1);
}

TEST(ReflectionPool, VisitsEachNeighbourOnceAndItselfWithAllWeight) {
    const ReflectionPool pool(flatFloor(0.1f, 1e4f), kSide, kSide);
    std::vector<int> visits(kSide * kSide);
    pool.visit(kMiddle, [&](size_t i, float weight) {
        ++visits[i];
        EXPECT_LE(weight, 16);
        if (i == kMiddle) {
            EXPECT_EQ(weight, 16);
        }
    });
    int neighbours = 0;
    for (int count : visits) {
        EXPECT_LE(count, 1);
        neighbours += count;
    }
    EXPECT_EQ(neighbours, 7 * 7);
}

}  // namespace
}  // namespace phat::test
