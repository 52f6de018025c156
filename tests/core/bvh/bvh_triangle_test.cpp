#include "core/bvh/bvh_triangle.h"

#include <gtest/gtest.h>

#include "support/ray_scenes.h"

namespace phat::test {
namespace {

TEST(BvhTriangle, CornersAreStoredWithinHalfAStep) {
    Rng rng(32);
    for (const float size : {1e-9f, 1e-3f, 1.0f, 7.3f, 1e4f, 1e9f}) {
        const glm::vec3 box = size * glm::vec3(1, 0.01f, 30);
        const glm::vec3 extremes[] = {box, -box};
        const BvhGrid grid = gridOver(extremes);
        for (int axis = 0; axis < 3; ++axis) EXPECT_LE(grid.maxError()[axis], box[axis] * 0x1p-27f) << size;
        for (int i = 0; i < 2000; ++i) {
            std::array<glm::vec3, 3> corners;
            for (glm::vec3& corner : corners) corner = box * randomPoint(rng);
            corners[i % 3] = i % 2 ? box : -box;
            if (i % 5 == 0) corners[2] = glm::vec3(0, -0.0f, box.z);
            const auto stored = cornersOf(grid, packTriangle(grid, corners));
            for (size_t corner = 0; corner < 3; ++corner) {
                for (int axis = 0; axis < 3; ++axis) {
                    const float want = corners[corner][axis], is = stored[corner][axis];
                    ASSERT_LE(std::abs(double(want) - double(is)), double(grid.maxError()[axis])) << size;
                    if (std::abs(want) >= box[axis] / 8) {
                        ASSERT_EQ(want, is) << size;
                    }
                }
            }
        }
    }
}

TEST(BvhTriangle, FarCoordinatesAreClamped) {
    const std::array<glm::vec3, 3> corners{glm::vec3(1e30f, -1e30f, 0), glm::vec3(0), glm::vec3(1, 2, 3e38f)};
    const BvhGrid grid = gridOver(corners);
    const auto stored = cornersOf(grid, packTriangle(grid, corners));
    EXPECT_EQ(stored[0].y, -kMaxCoordinate);
    EXPECT_NEAR(stored[0].x, kMaxCoordinate, grid.stepMeters.x);
    EXPECT_NEAR(stored[2].z, kMaxCoordinate, grid.stepMeters.z);
}

}  // namespace
}  // namespace phat::test
