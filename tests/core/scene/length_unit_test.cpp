#include "core/scene/length_unit.h"

#include <gtest/gtest.h>

#include "support/scaled_scene.h"

namespace phat {
namespace {

using namespace test;

TEST(LengthUnit, IsAboutAMetreInARoom) {
    Scene scene;
    EXPECT_EQ(lengthUnit(scene), 1);
    addRoom(scene, lambert(0.5f), {5, 3, 4});
    EXPECT_NEAR(lengthUnit(scene), std::sqrt(50.0f) / 8, 1e-6f);
}

TEST(LengthUnit, GrowsWithTheSceneAndNotWithItsGround) {
    Scene scene;
    addRoom(scene, lambert(0.5f), {5, 3, 4});
    addFloor(scene, lambert(0.5f), 1000, -0.01f);
    const float unit = lengthUnit(scene);
    EXPECT_NEAR(unit, std::sqrt(50.0f) / 8, 1e-6f);
    EXPECT_EQ(lengthUnit(scaledScene(scene, 1024)), 1024 * unit);
    EXPECT_EQ(lengthUnit(scaledScene(scene, 0x1p-10f)), 0x1p-10f * unit);
    EXPECT_NEAR(lengthUnit(scaledScene(scene, 1000)), 1000 * unit, 1e-3f * unit);
}

}  // namespace
}  // namespace phat
