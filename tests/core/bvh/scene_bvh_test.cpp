#include "core/bvh/scene_bvh.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "core/bvh/posed_bvh.h"
#include "support/ray_scenes.h"

namespace phat::test {
namespace {

// Counts the triangles below a group's root; each must be inside of all boxes above it.
class Walk {
  public:
    explicit Walk(const SceneBvh& bvh) : seen(bvh.triangles.size(), 0), bvh_(bvh) {}

    void below(uint32_t root) {
        struct Entry {
            uint32_t node;
            Bounds around;
        };
        std::vector<Entry> pending{{root, {glm::vec3(-1e30f), glm::vec3(1e30f)}}};
        while (!pending.empty()) {
            const auto [node, around] = pending.back();
            pending.pop_back();
            const NodeChildren children = unpackNode(bvh_.nodes[node]);
            uint32_t triangleIndex = children.firstTriangle;
            for (int child = 0; child < children.count; ++child) {
                const Bounds& box = children.boxes[size_t(child)];
                const Bounds both{glm::max(around.low, box.low), glm::min(around.high, box.high)};
                if (children.leafTriangles[size_t(child)] == 0) {
                    const uint32_t inner = children.firstInner + uint32_t(child);
                    ASSERT_GT(inner, node);
                    pending.push_back({inner, both});
                }
                for (uint32_t i = 0; i < children.leafTriangles[size_t(child)]; ++i)
                    triangle(triangleIndex++, both);
            }
        }
    }

    std::vector<int> seen;

  private:
    void triangle(uint32_t index, const Bounds& inside) {
        ++seen[index];
        for (const glm::vec3& corner : cornersOf(bvh_.grid, bvh_.triangles[index])) {
            ASSERT_EQ(corner, glm::clamp(corner, inside.low, inside.high));
        }
    }

    const SceneBvh& bvh_;
};

void expectIsWhole(const SceneBvh& bvh, const Scene& scene) {
    ASSERT_EQ(bvh.order.size(), scene.triangles.size());
    std::vector<int> held(scene.triangles.size(), 0);
    for (const uint32_t triangle : bvh.order) ++held[triangle];
    EXPECT_EQ(std::count(held.begin(), held.end(), 1), int(held.size()));
    Walk walk(bvh);
    for (const BvhGroup& group : bvh.groups) {
        walk.below(group.root);
        EXPECT_LE(group.stackWords, kBvhStackWords);
        for (uint32_t i = group.firstTriangle; i < group.firstTriangle + group.triangleCount; ++i) {
            const uint32_t triangle = bvh.order[i];
            EXPECT_EQ(scene.surfaces[scene.triangleSurface[triangle]].node, group.gltfNode);
            const bool opaque = scene.materialOf(triangle).alphaMode == AlphaMode::opaque;
            EXPECT_EQ(opaque, i < bvh.firstTransparent);
        }
    }
    EXPECT_EQ(std::count(walk.seen.begin(), walk.seen.end(), 1), int(walk.seen.size()));
}

TEST(SceneBvh, HoldsEachTriangleOnceInsideOfItsBoxes) {
    for (const Scene& scene : {triangleSoup(1, 0.5f), triangleSoup(3000, 0.1f), sphere({100, -50, 3}, 2, 20),
                               roomOfSpheres(9), triangleSoup(5, 1e-8f)})
        expectIsWhole(buildSceneBvh(scene), scene);
}

TEST(SceneBvh, OfNothingIsEmpty) {
    const SceneBvh bvh = buildSceneBvh(Scene{});
    EXPECT_TRUE(bvh.nodes.empty() && bvh.triangles.empty() && bvh.groups.empty());
    EXPECT_EQ(poseBvh(bvh, {}).nodes.size(), 1u);
}

TEST(SceneBvh, IsTheSameOnAnyNumberOfThreads) {
    Scene scene = triangleSoup(30000, 0.05f);
    addNode(scene, roomOfSpheres(6), 1);
    const auto build = [&](size_t threads) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        return buildSceneBvh(scene);
    };
    const SceneBvh one = build(1), four = build(4);
    EXPECT_EQ(one.nodes, four.nodes);
    EXPECT_EQ(one.triangles, four.triangles);
    EXPECT_EQ(one.order, four.order);
}

TEST(SceneBvh, TakesAtMostFortyBytesATriangle) {
    for (const Scene& scene : {sphere(glm::vec3(0), 1, 60), sphere({3, 2, 1}, 0.1f, 20)}) {
        const SceneBvh bvh = buildSceneBvh(scene);
        const size_t bytes = sizeof(BvhNode) * (bvh.nodes.size() + poseBvh(bvh, {}).nodes.size()) +
                             sizeof(BvhTriangle) * bvh.triangles.size();
        EXPECT_LE(double(bytes) / double(scene.triangles.size()), 40.0);
    }
}

TEST(SceneBvh, RefusesTooManyTriangles) {
    Scene scene;
    scene.triangles.resize(kMaxBvhTriangles + 1);
    EXPECT_THROW(buildSceneBvh(scene), std::length_error);
}

TEST(PosedBvh, HasAtMostAsManyNodesAsItSays) {
    for (const int spheres : {0, 1, 2, 7, 40}) {
        const Scene scene = roomOfSpheres(spheres);
        const SceneBvh bvh = buildSceneBvh(scene);
        glm::mat4 away(1);
        away[3] = glm::vec4(0, 1, 0, 1);
        const std::vector<glm::mat4> moved(size_t(spheres) + 1, away);
        EXPECT_LE(poseBvh(bvh, {}).nodes.size(), maxPosedNodes(bvh));
        EXPECT_LE(poseBvh(bvh, moved).nodes.size(), maxPosedNodes(bvh));
    }
}

}  // namespace
}  // namespace phat::test
