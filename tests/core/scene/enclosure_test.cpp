#include "core/scene/enclosure.h"

#include <gtest/gtest.h>

#include "support/scaled_scene.h"
#include "support/scene_builder.h"

namespace phat {
namespace {

using namespace test;

bool isInRoom(const std::vector<Bounds>& boxes, glm::vec3 p) {
    return std::any_of(boxes.begin(), boxes.end(), [&](const Bounds& box) {
        return glm::all(glm::greaterThanEqual(p, box.low)) && glm::all(glm::lessThanEqual(p, box.high));
    });
}

constexpr float kHeight = 2.7f;

// 6 x 6 m without the quarter where x and z are above 3: walls whose fronts look inward.
Scene roomAroundACorner(float floor = 0) {
    constexpr glm::vec2 kOutline[] = {{0, 0}, {6, 0}, {6, 3}, {3, 3}, {3, 6}, {0, 6}};
    Scene scene;
    for (size_t i = 0; i < std::size(kOutline); ++i) {
        const glm::vec2 a = kOutline[i], b = kOutline[(i + 1) % std::size(kOutline)];
        addQuad(scene, lambert(0.5f), {a.x, floor, a.y}, {b.x - a.x, 0, b.y - a.y}, {0, kHeight, 0});
    }
    for (const glm::vec2 size : {glm::vec2(6, 3), glm::vec2(3, 6)}) {
        addQuad(scene, lambert(0.5f), {0, floor, 0}, {0, 0, size.y}, {size.x, 0, 0});
        addQuad(scene, lambert(0.5f), {0, floor + kHeight, 0}, {size.x, 0, 0}, {0, 0, size.y});
    }
    return scene;
}

TEST(RoomBoxes, FollowTheGroundPlan) {
    // A step of the grid, and how near to a wall one does not stand.
    constexpr float kReach = 6.0f / 16 + 0.1f * kHeight;
    for (const float unit : {1.0f, 1000.0f}) {
        const std::vector<Bounds> boxes = roomBoxes(RayScene(scaledScene(roomAroundACorner(), unit)));
        const auto has = [&](glm::vec3 p) { return isInRoom(boxes, unit * p); };
        for (float x = 0.05f; x < 6; x += 0.1f)
            for (float z = 0.05f; z < 6; z += 0.1f) {
                const glm::vec3 eye(x, 1.6f, z);
                if (x < 3 || z < 3) {
                    EXPECT_TRUE(has(eye)) << x << ' ' << z;
                }
                if (std::min(x, z) > 3 + kReach) {
                    EXPECT_FALSE(has(eye)) << x << ' ' << z;
                }
            }
        EXPECT_TRUE(has({1, 0.1f, 1}));
        EXPECT_TRUE(has({1, kHeight - 0.1f, 1}));
        EXPECT_FALSE(has({1, kHeight + 0.1f, 1}));
        EXPECT_FALSE(has({-kReach, 1.6f, 2}));
        EXPECT_LT(boxes.size(), 40u);
    }
}

TEST(RoomBoxes, AreOfAllStoreys) {
    constexpr float kUpstairs = kHeight + 0.3f;
    Scene scene = roomAroundACorner();
    const Scene above = roomAroundACorner(kUpstairs);
    for (const glm::uvec3& t : above.triangles) {
        const glm::vec3 corners[] = {above.positions[t.x], above.positions[t.y], above.positions[t.z]};
        const glm::vec2 uv[] = {{0, 0}, {1, 0}, {0, 1}};
        addTriangle(scene, corners, uv);
    }
    const std::vector<Bounds> boxes = roomBoxes(RayScene(scene));
    EXPECT_TRUE(isInRoom(boxes, {1, 1.6f, 1}));
    EXPECT_FALSE(isInRoom(boxes, {1, kHeight + 0.15f, 1})) << "between ceiling and floor";
    EXPECT_TRUE(isInRoom(boxes, {1, kUpstairs + 1.6f, 1}));
}

TEST(RoomBoxes, AreNoneWhereThereIsNoInside) {
    Scene scene;
    EXPECT_TRUE(roomBoxes(RayScene(scene)).empty());
    addFloor(scene, lambert(0.5f), 4);
    EXPECT_TRUE(roomBoxes(RayScene(scene)).empty());
    // The inside of a hollow block.
    Scene block = roomAroundACorner();
    for (glm::uvec3& t : block.triangles) std::swap(t.y, t.z);
    for (Material& material : block.materials) material.doubleSided = true;
    EXPECT_TRUE(roomBoxes(RayScene(block)).empty());
}

}  // namespace
}  // namespace phat
