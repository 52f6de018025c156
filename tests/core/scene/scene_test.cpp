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

}  // namespace
}  // namespace phat
