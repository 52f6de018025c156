#include "core/scene/default_camera.h"

#include <gtest/gtest.h>

#include "core/scene/enclosure.h"
#include "core/scene/seen_light.h"
#include "support/glass_scenes.h"
#include "support/scene_builder.h"

namespace phat {
namespace {

using namespace test;

// A box whose fronts look outward.
void addBox(Scene& scene, Material material, glm::vec3 low, glm::vec3 high) {
    Scene inward;
    addRoom(inward, material, high - low);
    for (const glm::uvec3& t : inward.triangles) {
        if (t == inward.triangles.front()) addSurface(scene, material);
        const glm::vec3 corners[] = {low + inward.positions[t.x], low + inward.positions[t.z],
                                     low + inward.positions[t.y]};
        const glm::vec2 uv[] = {{0, 0}, {1, 0}, {0, 1}};
        addTriangle(scene, corners, uv);
    }
}

DefaultView viewOf(const Scene& scene) {
    return defaultView(RayScene(scene), LightSampler(scene));
}

glm::vec3 eyeOf(const DefaultView& view) {
    return glm::vec3(view.camera.worldFromCamera[3]);
}

Scene scaled(Scene scene, float factor) {
    for (glm::vec3& p : scene.positions) p *= factor;
    return scene;
}

// 2.667 m high, so that 1.6 m are six tenths in any unit.
constexpr glm::vec3 kRoom(5, 1.6f / kEyeFraction, 4);

Scene furnishedRoom() {
    Scene scene;
    addRoom(scene, lambert(0.7f), kRoom);
    addBox(scene, lambert(0.4f), {0.1f, 0, 0.1f}, {1.9f, 0.5f, 1.0f});      // a sofa
    addBox(scene, lambert(0.4f), {2.0f, 0.7f, 1.5f}, {3.2f, 0.75f, 2.5f});  // a table's top
    addBox(scene, lambert(0.4f), {4.4f, 0, 0.1f}, {4.9f, 2.2f, 1.5f});      // a wardrobe
    return scene;
}

TEST(DefaultCamera, StandsInARoomAndLooksLevel) {
    const Scene scene = furnishedRoom();
    const DefaultView view = viewOf(scene);
    ASSERT_TRUE(view.inside);
    const glm::vec3 eye = eyeOf(view), forward = -glm::vec3(view.camera.worldFromCamera[2]);
    EXPECT_NEAR(eye.y, 1.6f, 1e-3f);
    EXPECT_NEAR(forward.y, 0, 1e-5f);
    EXPECT_NEAR(view.camera.worldFromCamera[1].y, 1, 1e-5f);
    EXPECT_NEAR(2 * std::tan(0.5f * view.camera.yfovRadians), 24.0f / 35, 1e-4f);
    for (int axis = 0; axis < 3; axis += 2) {
        EXPECT_GT(eye[axis], 0.2f);
        EXPECT_LT(eye[axis], kRoom[axis] - 0.2f);
    }
    // It looks across the room: the middle of the view is more than half of the room's width away.
    EXPECT_GT(glm::distance(eye, view.target), 2);
    EXPECT_FALSE(eye.x > 4.3f && eye.z < 1.6f) << "in the wardrobe";
}

// The eye is at 1.6 m whether the file is in metres, centimetres, millimetres or kilometres.
TEST(DefaultCamera, StandsAsHighInEveryUnit) {
    for (const float meter : {1.0f, 100.0f, 1000.0f, 0.001f}) {
        Scene scene;
        addRoom(scene, lambert(0.7f), meter * glm::vec3(5, 3.2f, 4));
        const DefaultView view = viewOf(scene);
        EXPECT_TRUE(view.inside) << meter;
        EXPECT_NEAR(eyeOf(view).y / meter, 1.6f, 1e-3f) << meter;
    }
}

// Many rooms are boxes whose fronts look outward, with double-sided materials. What is in them makes them
// rooms.
TEST(DefaultCamera, StandsInABoxOfDoubleSidedWallsIfThereIsSomethingInIt) {
    for (const bool furnished : {false, true}) {
        Scene scene;
        addBox(scene, lambert(0.7f), glm::vec3(0), kRoom);
        if (furnished) {
            addBox(scene, lambert(0.4f), {0.1f, 0, 0.1f}, {1.9f, 0.5f, 1.0f});
            addBox(scene, lambert(0.4f), {4.4f, 0, 0.1f}, {4.9f, 2.2f, 1.5f});
        }
        for (Material& material : scene.materials) material.doubleSided = true;
        const DefaultView view = viewOf(scene);
        EXPECT_EQ(view.inside, furnished);
        if (furnished) {
            EXPECT_FALSE(eyeOf(view).x > 4.3f && eyeOf(view).z < 1.6f) << "in the wardrobe";
        }
    }
}

TEST(DefaultCamera, IsTheSameInAnyUnit) {
    const DefaultView meters = viewOf(furnishedRoom());
    for (const float factor : {1000.0f, 0.001f}) {
        const DefaultView view = viewOf(scaled(furnishedRoom(), factor));
        ASSERT_TRUE(view.inside);
        EXPECT_NEAR(glm::distance(eyeOf(view) / factor, eyeOf(meters)), 0, 2e-3f);
        EXPECT_NEAR(glm::distance(glm::vec3(view.camera.worldFromCamera[2]),
                                  glm::vec3(meters.camera.worldFromCamera[2])),
                    0, 1e-3f);
        EXPECT_NEAR(view.camera.znear / factor, meters.camera.znear, 1e-4f);
    }
}

// All corners are within the frame, and on one pair of its sides they leave no more than the margin.
void expectTight(const DefaultView& view, std::span<const glm::vec3> corners) {
    EXPECT_FALSE(view.inside);
    const glm::mat4 cameraFromWorld = glm::inverse(view.camera.worldFromCamera);
    const float slope = std::tan(0.5f * view.camera.yfovRadians);
    glm::vec2 low(1), high(-1);
    for (const glm::vec3& corner : corners) {
        const glm::vec3 seen = cameraFromWorld * glm::vec4(corner, 1);
        EXPECT_GT(-seen.z, view.camera.znear);
        const glm::vec2 at = glm::vec2(seen) / (-seen.z * slope * glm::vec2(1.5f, 1));
        low = glm::min(low, at);
        high = glm::max(high, at);
    }
    const glm::vec2 most = glm::max(-low, high);
    EXPECT_LE(std::max(most.x, most.y), 0.96f);
    EXPECT_GE(std::max(most.x, most.y), 0.94f);
    EXPECT_GT(view.camera.worldFromCamera[3].y, view.target.y) << "from above";
}

TEST(DefaultCamera, FramesAThingFromOutside) {
    for (const bool doubleSided : {false, true}) {
        for (const glm::vec3 size :
             {glm::vec3(1), glm::vec3(0.001f, 0.002f, 0.004f), glm::vec3(300, 2, 40)}) {
            Scene scene;
            Material material = lambert(0.5f);
            material.doubleSided = doubleSided;
            addBox(scene, material, -0.5f * size, 0.5f * size);
            std::vector<glm::vec3> corners;
            for (int i = 0; i < 8; ++i)
                corners.push_back(size * (glm::vec3(i & 1, i >> 1 & 1, i >> 2) - 0.5f));
            expectTight(viewOf(scene), corners);
        }
    }
}

TEST(DefaultCamera, LeavesTheGroundOutOfTheFrame) {
    Scene scene;
    addBox(scene, lambert(0.5f), {-1, 0, -1}, {1, 2, 1});
    const DefaultView without = viewOf(scene);
    addFloor(scene, lambert(0.5f), 1000, -0.001f);
    const DefaultView with = viewOf(scene);
    EXPECT_NEAR(glm::distance(eyeOf(with), eyeOf(without)), 0, 1e-3f);
    // A ground alone is all there is to see.
    Scene ground;
    addFloor(ground, lambert(0.5f), 1000);
    EXPECT_GT(eyeOf(viewOf(ground)).y, 100);
}

TEST(DefaultCamera, LooksIntoARoomWithoutACeilingFromOutside) {
    Scene scene = furnishedRoom();
    Scene open;
    for (uint32_t t = 0; t < scene.triangles.size(); ++t) {
        const glm::uvec3 corner = scene.triangles[t];
        const glm::vec3 corners[] = {scene.positions[corner.x], scene.positions[corner.y],
                                     scene.positions[corner.z]};
        if (std::min({corners[0].y, corners[1].y, corners[2].y}) > kRoom.y - 0.01f) continue;
        if (open.surfaces.empty()) addSurface(open, lambert(0.5f));
        const glm::vec2 uv[] = {{0, 0}, {1, 0}, {0, 1}};
        addTriangle(open, corners, uv);
    }
    EXPECT_FALSE(viewOf(open).inside);
}

// Two equal rooms side by side: the view is of the one in which there is light.
TEST(DefaultCamera, PrefersWhatIsLit) {
    for (const float x : {1.0f, 7.0f}) {
        Scene scene;
        addRoom(scene, lambert(0.7f), {8, 2.5f, 4});
        addBox(scene, lambert(0.7f), {3.9f, 0, 0}, {4.1f, 2.5f, 4});
        scene.lights.push_back(pointLight(glm::vec3(10), {x, 2, 2}));
        const DefaultView view = viewOf(scene);
        ASSERT_TRUE(view.inside);
        EXPECT_EQ(eyeOf(view).x < 4, x < 4);
    }
}

// Wherever the only thing in a room stands, the view shows it rather than a bare wall.
TEST(DefaultCamera, ShowsWhatStandsInTheRoom) {
    const glm::vec3 room(4, kRoom.y, 4), middle(2, 0, 2);
    for (const glm::vec3 wall :
         {glm::vec3(1, 0, 0), glm::vec3(-1, 0, 0), glm::vec3(0, 0, 1), glm::vec3(0, 0, -1)}) {
        Scene scene;
        addRoom(scene, lambert(0.7f), room);
        const glm::vec3 center = middle + 1.8f * wall;
        const glm::vec3 half = 0.15f * glm::abs(wall) + 0.7f * glm::abs(glm::vec3(wall.z, 0, wall.x));
        addBox(scene, lambert(0.4f), center - half, center + half + glm::vec3(0, 1.4f, 0));
        const DefaultView view = viewOf(scene);
        ASSERT_TRUE(view.inside);
        const glm::vec3 top = center + glm::vec3(0, 1.4f, 0) - 0.15f * wall;
        const glm::vec4 seen = glm::inverse(view.camera.worldFromCamera) * glm::vec4(top, 1);
        const float slope = std::tan(0.5f * view.camera.yfovRadians);
        EXPECT_LT(std::abs(seen.x), -seen.z * slope * 1.5f) << wall.x << ' ' << wall.z;
        EXPECT_LT(std::abs(seen.y), -seen.z * slope) << wall.x << ' ' << wall.z;
    }
}

TEST(DefaultCamera, IsFiniteWithoutAScene) {
    EXPECT_TRUE(std::isfinite(defaultCamera(Scene()).worldFromCamera[3].z));
    Scene point;
    addQuad(point, lambert(0.5f), {1, 1, 1}, {1e-12f, 0, 0}, {0, 0, 1e-12f});
    EXPECT_TRUE(std::isfinite(defaultCamera(point).worldFromCamera[3].z));
}

TEST(SeenLight, DaylightComesThroughAWindowOnly) {
    Scene closed = furnishedRoom();
    const Camera camera = viewOf(closed).camera;
    EXPECT_EQ(daylightFraction(RayScene(closed), camera), 0);
    // The wall x = 0 is made of two strips with a gap of a metre between them.
    Scene open;
    addFloor(open, lambert(0.7f), 6);
    addCeiling(open, lambert(0.7f), 6, 2.5f);
    for (const float z : {-3.0f, 3.0f}) {
        addQuad(open, lambert(0.7f), {-3, 0, z}, {6, 0, 0}, {0, 2.5f, 0});
        addQuad(open, lambert(0.7f), {z, 0, -3}, {0, 2.5f, 0}, {0, 0, z > 0 ? 6 : 2.5f});
    }
    addQuad(open, lambert(0.7f), {-3, 0, 0.5f}, {0, 2.5f, 0}, {0, 0, 2.5f});
    for (Material& material : open.materials) material.doubleSided = true;
    const DefaultView view = viewOf(open);
    ASSERT_TRUE(view.inside);
    const float fraction = daylightFraction(RayScene(open), view.camera);
    EXPECT_GT(fraction, 0.02f);
    EXPECT_LT(fraction, 0.9f);
    // Things under the sky are lit.
    Scene thing;
    addBox(thing, lambert(0.5f), glm::vec3(-1), glm::vec3(1));
    EXPECT_GT(daylightFraction(RayScene(thing), viewOf(thing).camera), 0.95f);
}

TEST(SeenLight, ALampLightsARoomAndALabelDoesNot) {
    Scene room = furnishedRoom();
    const Camera camera = viewOf(room).camera;
    EXPECT_EQ(litFraction(RayScene(room), LightSampler(room), camera), 0);
    addQuad(room, emitter(glm::vec3(5)), {2, 2.6f, 1.5f}, {1, 0, 0}, {0, 0, 1});
    EXPECT_GT(litFraction(RayScene(room), LightSampler(room), camera), 0.5f);
    Scene label;
    addBox(label, lambert(0.5f), glm::vec3(-1), glm::vec3(1));
    addQuad(label, emitter(glm::vec3(5)), {-0.2f, -0.2f, 1.001f}, {0.4f, 0, 0}, {0, 0.4f, 0});
    const DefaultView view = viewOf(label);
    EXPECT_LT(litFraction(RayScene(label), LightSampler(label), view.camera), 0.05f);
}

// What is behind glass is seen, lit through it, and daylight comes in by it.
TEST(DefaultCamera, LooksThroughGlass) {
    const auto hall = [](const Material& pane) {
        Scene scene;
        addRoom(scene, lambert(0.7f), {4, 3, 12});
        addQuad(scene, pane, {0, 0, 6}, {4, 0, 0}, {0, 3, 0});
        return scene;
    };
    Material wall = lambert(0.7f);
    wall.doubleSided = true;
    const auto depthOf = [](const DefaultView& view) { return glm::distance(view.target, eyeOf(view)); };
    EXPECT_LT(depthOf(viewOf(hall(wall))), 6.5f);
    EXPECT_GT(depthOf(viewOf(hall(glass()))), 6.5f);

    Camera camera;
    camera.worldFromCamera[3] = glm::vec4(2, 1.5f, 1, 1);
    camera.worldFromCamera[0].x = camera.worldFromCamera[2].z = -1;  // toward +z, where the pane is
    const auto litOf = [&](const Material& pane) {
        Scene scene = hall(pane);
        scene.lights.push_back(pointLight(glm::vec3(10), {2, 2.5f, 11}));
        return litFraction(RayScene(scene), LightSampler(scene), camera);
    };
    EXPECT_LT(litOf(wall), 0.01f);
    EXPECT_GT(litOf(glass()), 0.9f);

    // The wall at the end is one pane.
    const auto daylightOf = [&](const Material& pane) {
        Scene scene;
        addRoom(scene, lambert(0.7f), {4, 3, 12});
        scene.materials[scene.surfaces[5].material] = pane;
        return daylightFraction(RayScene(scene), camera);
    };
    EXPECT_EQ(daylightOf(wall), 0);
    EXPECT_GT(daylightOf(glass()), 0.1f);
}

}  // namespace
}  // namespace phat
