#include "core/scene/scene.h"

#include <gtest/gtest.h>

#include "support/scene_builder.h"

namespace phat {
namespace {

using namespace test;

TEST(Bounds, AreOfTrianglesOnly) {
    Scene scene;
    EXPECT_TRUE(boundsOf(scene).empty());
    EXPECT_EQ(boundsOf(scene).diagonal(), 0);
    addQuad(scene, lambert(0.5f), {1, 2, 3}, {4, 0, 0}, {0, 0, -3});
    scene.positions.push_back(glm::vec3(1000));
    const Bounds bounds = boundsOf(scene);
    EXPECT_EQ(bounds.low, glm::vec3(1, 2, 0));
    EXPECT_EQ(bounds.high, glm::vec3(5, 2, 3));
    EXPECT_EQ(bounds.center(), glm::vec3(3, 2, 1.5f));
    EXPECT_FLOAT_EQ(bounds.diagonal(), 5);
}

// Every corner of the box is in front of the camera and within its square field of view.
TEST(DefaultCamera, SeesTheWholeScene) {
    for (const glm::vec3 size : {glm::vec3(1), glm::vec3(0.001f, 0.002f, 0.01f), glm::vec3(300, 2, 40)}) {
        Scene scene;
        addRoom(scene, lambert(0.5f), size);
        const Camera camera = defaultCamera(scene);
        const glm::mat4 cameraFromWorld = glm::inverse(camera.worldFromCamera);
        const float slope = std::tan(0.5f * camera.yfovRadians);
        for (int i = 0; i < 8; ++i) {
            const glm::vec3 corner = size * glm::vec3(i & 1, i >> 1 & 1, i >> 2);
            const glm::vec3 seen = cameraFromWorld * glm::vec4(corner, 1);
            EXPECT_GT(-seen.z, camera.znear);
            EXPECT_LE(std::abs(seen.x), -seen.z * slope);
            EXPECT_LE(std::abs(seen.y), -seen.z * slope);
        }
        EXPECT_GT(camera.worldFromCamera[1].y, 0.5f) << "up is up";
    }
    EXPECT_TRUE(std::isfinite(defaultCamera(Scene()).worldFromCamera[3].z));
}

}  // namespace
}  // namespace phat
