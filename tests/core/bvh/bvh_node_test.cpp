#include "core/bvh/bvh_node.h"

#include <gtest/gtest.h>

#include <bit>

#include "support/ray_scenes.h"

namespace phat::test {
namespace {

// As a traversal reads it, in double.
double storedBound(const BvhNode& node, int child, int axis, bool high) {
    const uint32_t byte = node.words[size_t((high ? 7 : 4) + axis)] >> (8 * child) & 255;
    const int exponent = int(node.words[3] >> (8 * axis) & 255) - 127;
    return double(std::bit_cast<float>(node.words[size_t(axis)])) + std::ldexp(double(byte), exponent);
}

TEST(BvhNode, BoxesAreRoundedOutwardsByLittle) {
    Rng rng(31);
    for (int i = 0; i < 20000; ++i) {
        NodeChildren children;
        children.count = 1 + int(rng.bits() % kBvhWidth);
        const float size = std::exp2(60 * rng.uniform() - 30), away = std::exp2(60 * rng.uniform() - 30);
        const glm::vec3 center = away * randomPoint(rng);
        Bounds all;
        for (int child = 0; child < children.count; ++child) {
            Bounds& box = children.boxes[size_t(child)];
            box.add(center + size * randomPoint(rng));
            box.add(center + size * randomPoint(rng));
            if (i % 3 == 0) box.high[i % 2] = box.low[i % 2];  // flat
            all.add(box.low);
            all.add(box.high);
        }
        const BvhNode node = packNode(children);
        for (int child = 0; child < children.count; ++child) {
            for (int axis = 0; axis < 3; ++axis) {
                const Bounds& box = children.boxes[size_t(child)];
                const double low = storedBound(node, child, axis, false);
                const double high = storedBound(node, child, axis, true);
                ASSERT_LE(low, box.low[axis]) << i;
                ASSERT_GE(high, box.high[axis]) << i;
                // Units are at most 2/255 of the extent.
                const double extent = double(all.high[axis]) - double(all.low[axis]);
                const double unit = std::max(2 * extent / 255, 0x1p-100);
                ASSERT_GE(low, box.low[axis] - unit) << i;
                ASSERT_LE(high, box.high[axis] + unit) << i;
            }
        }
    }
}

TEST(BvhNode, ChildrenReadBackAsWritten) {
    for (int innerCount = 0; innerCount <= kBvhWidth; ++innerCount) {
        for (int count = innerCount; count <= kBvhWidth; ++count) {
            NodeChildren children;
            children.count = count;
            children.firstInner = (1u << kBvhIndexBits) - 5;
            children.firstTriangle = 123456789;
            for (int child = 0; child < count; ++child) {
                children.boxes[size_t(child)] = {glm::vec3(float(child)), glm::vec3(float(child) + 1)};
                if (child >= innerCount)
                    children.leafTriangles[size_t(child)] = 1 + uint32_t(child) % kMaxLeafTriangles;
            }
            const BvhNode node = packNode(children);
            EXPECT_FALSE(isInstance(node));
            const NodeChildren read = unpackNode(node);
            EXPECT_EQ(read.count, count);
            EXPECT_EQ(read.firstInner, children.firstInner);
            EXPECT_EQ(read.firstTriangle, children.firstTriangle);
            EXPECT_EQ(read.leafTriangles, children.leafTriangles) << innerCount << ' ' << count;
        }
    }
    EXPECT_EQ(unpackNode(emptyNode()).count, 0);
}

TEST(BvhNode, InstancesReadBackAsWritten) {
    for (const bool mirrored : {false, true}) {
        const BvhNode node = packInstance({11, 22, mirrored});
        EXPECT_TRUE(isInstance(node));
        const BvhInstance read = BvhInstance::of(node);
        EXPECT_EQ(read.root, 11u);
        EXPECT_EQ(read.matrixNode, 22u);
        EXPECT_EQ(read.mirrored, mirrored);
    }
    glm::mat4 m(1);
    m[3] = glm::vec4(4, 5, 6, 1);
    m[1][0] = 7;
    const BvhNode rows = packMatrix(m);
    EXPECT_EQ(std::bit_cast<float>(rows.words[1]), 7.0f);
    EXPECT_EQ(std::bit_cast<float>(rows.words[3]), 4.0f);
    EXPECT_EQ(std::bit_cast<float>(rows.words[11]), 6.0f);
}

}  // namespace
}  // namespace phat::test
