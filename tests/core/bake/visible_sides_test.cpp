// Which sides receive texels in a bake for light that comes later.

#include "core/bake/visible_sides.h"

#include <gtest/gtest.h>

#include "support/scene_builder.h"

namespace phat {
namespace {

using namespace test;

Material doubleSided() {
    Material material = lambert(0.6f);
    material.doubleSided = true;
    return material;
}

std::vector<Sides> sidesOf(const Scene& scene) {
    const RayScene rays(scene);
    const LightSampler lights(scene);
    SilentProgress progress;
    PhotonSettings settings;
    settings.count = 20'000;
    return visibleSides({rays, lights}, tracePhotons(rays, lights, settings, progress));
}

// Faces of a box that stands on the floor of a room, whose surfaces come first.
constexpr size_t kBox = 6, kBottom = kBox + 2, kFront = kBox + 5, kBoxEnd = kBox + 6;

Scene roomWithBox() {
    Scene scene;
    addRoom(scene, lambert(0.6f), {4, 3, 4});
    addOutwardBox(scene, doubleSided(), {1, 0, 1}, {0.6f, 0.6f, 0.6f});
    return scene;
}

void expectInsideIsVisible(const std::vector<Sides>& sides, bool visible) {
    for (size_t face = kBox; face < kBoxEnd; ++face) {
        const Sides open = face == kBottom ? Sides::back : Sides::both;
        EXPECT_EQ(sides[face], visible ? open : Sides::front) << face;
    }
}

// A room of double-sided walls, of which the last one looks outward. Nothing lights it.
Scene darkRoom() {
    Scene scene;
    addRoom(scene, doubleSided(), {4, 3, 4});
    for (size_t t = scene.triangles.size() - 2; t < scene.triangles.size(); ++t)
        std::swap(scene.triangles[t].y, scene.triangles[t].z);
    return scene;
}

TEST(VisibleSides, ARoomsInsideIsVisibleInTheDark) {
    const std::vector<Sides> sides = sidesOf(darkRoom());
    for (size_t wall = 0; wall < 6; ++wall) EXPECT_EQ(sides[wall], wall < 5 ? Sides::front : Sides::back);
}

TEST(VisibleSides, InsidesOfClosedSolidsAreNot) {
    expectInsideIsVisible(sidesOf(roomWithBox()), false);
}

// Each sees sides of the other that are visible elsewhere.
TEST(VisibleSides, NorAreThoseOfSolidsThatReachIntoEachOther) {
    Scene scene = roomWithBox();
    addOutwardBox(scene, doubleSided(), {1.3f, 0.2f, 1.3f}, {0.6f, 0.6f, 0.6f});
    for (const Sides sides : sidesOf(scene)) EXPECT_EQ(sides, Sides::front);
}

TEST(VisibleSides, WhereALampIsThatIsOffTheyAre) {
    Scene scene = roomWithBox();
    scene.lights = {pointLight(glm::vec3(0), {1.3f, 0.3f, 1.3f})};
    expectInsideIsVisible(sidesOf(scene), true);
}

TEST(VisibleSides, TheOutsideOfARoomIsWhereACameraIsThere) {
    Scene scene = darkRoom();
    Camera camera;
    camera.worldFromCamera[3] = {2, 1.5f, 20, 1};
    scene.cameras = {camera};
    for (const Sides sides : sidesOf(scene)) EXPECT_EQ(sides, Sides::both);
}

TEST(VisibleSides, AThingInTheOpenIsVisibleFromAround) {
    Scene scene;
    addQuad(scene, doubleSided(), {0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    for (const Sides sides : sidesOf(scene)) EXPECT_EQ(sides, Sides::both);
}

// A cupboard with a door as a node of its own.
TEST(VisibleSides, WhatAnAnimationOpensIsVisible) {
    Scene scene = roomWithBox();
    const uint32_t doorNode = 1;
    scene.nodes.resize(2);
    scene.surfaces[kFront].node = doorNode;
    for (const bool opens : {false, true}) {
        scene.animations.clear();
        if (opens)
            scene.animations = {
                {"open", {{doorNode, AnimationChannel::Path::rotation, {}, {0}, {glm::vec4(0)}}}}};
        expectInsideIsVisible(sidesOf(scene), opens);
    }
}

}  // namespace
}  // namespace phat
