// Which sides of double-sided surfaces receive texels.

#include "core/bake/lit_sides.h"

#include <gtest/gtest.h>

#include <tuple>

#include "support/scene_builder.h"

namespace phat {
namespace {

using namespace test;

Material doubleSided(Material material) {
    material.doubleSided = true;
    return material;
}

void addShade(Scene& scene, const Material& material, glm::vec3 low, glm::vec3 size) {
    const glm::vec3 x(size.x, 0, 0), y(0, size.y, 0), z(0, 0, size.z);
    for (const auto& [corner, along, across] :
         {std::tuple(low, y, x), std::tuple(low, z, y), std::tuple(low, x, z), std::tuple(low + z, x, y),
          std::tuple(low + x, y, z), std::tuple(low + y, z, x)})
        addQuad(scene, material, corner, along, across);
}

std::vector<Sides> sidesOf(const Scene& scene, uint64_t photonCount) {
    const RayScene rays(scene);
    const LightSampler lights(scene);
    SilentProgress progress;
    PhotonSettings settings;
    settings.count = photonCount;
    return litSides({rays, lights}, tracePhotons(rays, lights, settings, progress));
}

// A room of 4 m with a lamp, and a closed box in it with a lamp a thousand times as bright.
Scene roomWithShade(float insideNit, bool lampInRoom) {
    Scene scene;
    addRoom(scene, doubleSided(lambert(0.6f)), {4, 3, 4});
    addShade(scene, doubleSided(lambert(0.6f)), {1.5f, 1, 1.5f}, {0.5f, 0.5f, 0.5f});
    if (insideNit > 0)
        addQuad(scene, emitter(glm::vec3(insideNit)), {1.7f, 1.25f, 1.7f}, {0.1f, 0, 0}, {0, 0, 0.1f});
    if (lampInRoom) addQuad(scene, emitter(glm::vec3(4)), {1, 2.9f, 1}, {1, 0, 0}, {0, 0, 1});
    return scene;
}

TEST(LitSides, OutsideOfABrightShadeHasTexels) {
    for (const float nit : {4.0f, 400.0f, 40'000.0f}) {
        const std::vector<Sides> sides = sidesOf(roomWithShade(nit, true), 200'000);
        ASSERT_GE(sides.size(), 12u);
        for (int face = 6; face < 12; ++face) EXPECT_EQ(sides[size_t(face)], Sides::both) << nit;
        for (int face = 0; face < 6; ++face) EXPECT_EQ(sides[size_t(face)], Sides::front) << nit;
    }
}

TEST(LitSides, InsideOfAClosedBoxHasNone) {
    const std::vector<Sides> sides = sidesOf(roomWithShade(0, true), 100'000);
    for (int face = 6; face < 12; ++face) EXPECT_EQ(sides[size_t(face)], Sides::front);
}

TEST(LitSides, OutsideOfAClosedRoomHasNone) {
    Scene scene;
    addRoom(scene, doubleSided(lambert(0.6f)), {4, 3, 4});
    addQuad(scene, emitter(glm::vec3(4)), {1, 2.9f, 1}, {1, 0, 0}, {0, 0, 1});
    // A leak: a wall is off by a tenth of a millimetre.
    for (size_t v = 0; v < 6; ++v) scene.positions[v].x -= 1e-4f;
    const std::vector<Sides> sides = sidesOf(scene, 200'000);
    for (int face = 0; face < 6; ++face) EXPECT_EQ(sides[size_t(face)], Sides::front);
}

// A house of double-sided walls under a sun: its inside gets light by a window of a fiftieth of its walls.
TEST(LitSides, BothSidesOfAHouseUnderASunHaveTexels) {
    Scene house;
    const Material wall = doubleSided(lambert(0.6f));
    addQuad(house, wall, {0, 0, 0}, {0, 0, 4}, {4, 0, 0});     // floor
    addQuad(house, wall, {0, 3, 0}, {4, 0, 0}, {0, 0, 4});     // ceiling
    addQuad(house, wall, {0, 0, 0}, {4, 0, 0}, {0, 3, 0});     // z = 0
    addQuad(house, wall, {0, 0, 0}, {0, 3, 0}, {0, 0, 4});     // x = 0
    addQuad(house, wall, {4, 0, 0}, {0, 0, 4}, {0, 3, 0});     // x = 4
    addQuad(house, wall, {0, 0, 4}, {0, 3, 0}, {1.5f, 0, 0});  // beside the window
    addQuad(house, wall, {2.5f, 0, 4}, {0, 3, 0}, {1.5f, 0, 0});
    addQuad(house, wall, {1.5f, 0, 4}, {0, 1.5f, 0}, {1, 0, 0});  // below and above it
    addQuad(house, wall, {1.5f, 2.5f, 4}, {0, 0.5f, 0}, {1, 0, 0});
    addFloor(house, lambert(0.4f), 40, -0.1f);
    house.lights = {directionalLight(glm::vec3(1000),
                                     glm::normalize(glm::vec3(0.3f, -1, 0.6f)))};  // away from the window
    const std::vector<Sides> sides = sidesOf(house, 300'000);
    for (int face = 1; face < 9; ++face) EXPECT_EQ(sides[size_t(face)], Sides::both) << face;
}

TEST(LitSides, OneSidedSurfacesHaveTheirFront) {
    Scene scene;
    addRoom(scene, lambert(0.6f), {4, 3, 4});
    addQuad(scene, emitter(glm::vec3(4)), {1, 2.9f, 1}, {1, 0, 0}, {0, 0, 1});
    for (const Sides side : sidesOf(scene, 20'000)) EXPECT_EQ(side, Sides::front);
}

}  // namespace
}  // namespace phat
