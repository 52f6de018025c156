#include "core/bvh/restore_bvh.h"

#include <gtest/gtest.h>

#include "support/ray_scenes.h"

namespace phat::test {
namespace {

bool restores(const Scene& scene, const SceneBvh& damaged) {
    return restoreSceneBvh(scene, damaged.nodes, damaged.order).has_value();
}

TEST(RestoreBvh, GivesWhatWasBuilt) {
    for (const Scene& scene : {Scene{}, triangleSoup(1, 0.5f), triangleSoup(3000, 0.1f), roomOfSpheres(9)}) {
        const SceneBvh built = buildSceneBvh(scene);
        const auto restored = restoreSceneBvh(scene, built.nodes, built.order);
        ASSERT_TRUE(restored);
        EXPECT_EQ(restored->nodes, built.nodes);
        EXPECT_EQ(restored->order, built.order);
        EXPECT_EQ(restored->triangles, built.triangles);
        EXPECT_EQ(restored->firstTransparent, built.firstTransparent);
        EXPECT_EQ(restored->grid.stepMeters, built.grid.stepMeters);
        ASSERT_EQ(restored->groups.size(), built.groups.size());
        for (size_t i = 0; i < built.groups.size(); ++i) {
            const BvhGroup &is = restored->groups[i], &want = built.groups[i];
            EXPECT_EQ(is.gltfNode, want.gltfNode);
            EXPECT_EQ(is.root, want.root);
            EXPECT_EQ(is.firstTriangle, want.firstTriangle);
            EXPECT_EQ(is.triangleCount, want.triangleCount);
            EXPECT_EQ(is.stackWords, want.stackWords);
            EXPECT_EQ(is.bounds.low, want.bounds.low);
            EXPECT_EQ(is.bounds.high, want.bounds.high);
        }
    }
}

TEST(RestoreBvh, RefusesTreesOfAnotherScene) {
    const Scene scene = roomOfSpheres(6);
    const SceneBvh built = buildSceneBvh(scene);
    Scene moved = scene;
    for (uint32_t v = 0; v < 3; ++v) moved.positions[scene.surfaces[7].firstVertex + v].y += 0.5f;
    EXPECT_FALSE(restores(moved, built));
    Scene clear = scene;
    clear.materials[scene.surfaces[8].material].alphaMode = AlphaMode::blend;
    EXPECT_FALSE(restores(clear, built));
    EXPECT_FALSE(restores(roomOfSpheres(5), built));
}

TEST(RestoreBvh, RefusesCirclesAndWhatLeadsNowhere) {
    const Scene scene = triangleSoup(200, 0.2f);
    const SceneBvh built = buildSceneBvh(scene);
    ASSERT_GT(built.nodes.size(), 10u);
    ASSERT_GT(built.nodes[0].words[3] >> 24, 1u);
    const auto refuses = [&](auto&& damage) {
        SceneBvh damaged = built;
        damage(damaged);
        return !restores(scene, damaged);
    };
    EXPECT_TRUE(refuses([](SceneBvh& b) { b.nodes[0].words[10] &= 255; }));          // itself
    EXPECT_TRUE(refuses([](SceneBvh& b) { b.nodes[0].words[10] += 1u << 8; }));      // another's child
    EXPECT_TRUE(refuses([](SceneBvh& b) { b.nodes[0].words[10] |= 0xffffff00u; }));  // none
    EXPECT_TRUE(refuses([](SceneBvh& b) { b.nodes.push_back(b.nodes.back()); }));    // in no tree
    EXPECT_TRUE(refuses([](SceneBvh& b) { b.nodes.pop_back(); }));
    EXPECT_TRUE(refuses([](SceneBvh& b) { b.nodes.back().words[11] = 0xffffffffu; }));  // no such triangle
    EXPECT_TRUE(refuses([](SceneBvh& b) { b.nodes.back().words[11] -= 1; }));           // twice
    EXPECT_TRUE(refuses([](SceneBvh& b) { b.nodes[1].words[3] |= kInstance << 24; }));  // an instance
    EXPECT_TRUE(refuses([](SceneBvh& b) { b.nodes[1].words[3] |= 255; }));              // of infinite size
    EXPECT_TRUE(refuses([](SceneBvh& b) { b.nodes[1].words[0] = 0x7fc00000u; }));       // not a number
    EXPECT_TRUE(refuses([](SceneBvh& b) { b.nodes[0].words[4] = 0x00ffffffu; }));  // boxes beside triangles
    EXPECT_TRUE(refuses([](SceneBvh& b) { std::swap(b.order[0], b.order.back()); }));
    EXPECT_TRUE(refuses([](SceneBvh& b) { b.order[0] = b.order[1]; }));
    EXPECT_TRUE(refuses([](SceneBvh& b) { b.order.pop_back(); }));
}

// Nodes each of which has the two that follow as children: walked through as a tree they would be 2^40.
TEST(RestoreBvh, RefusesNodesOfTwoParentsAtOnce) {
    const Scene scene = triangleSoup(1, 0.5f);
    std::vector<BvhNode> nodes;
    for (uint32_t i = 0; i < 60; ++i) {
        NodeChildren children;
        children.count = 2;
        children.firstInner = i + 1;
        children.boxes.fill({glm::vec3(-2), glm::vec3(2)});
        nodes.push_back(packNode(children));
    }
    nodes.insert(nodes.end(), 2, emptyNode());
    EXPECT_FALSE(restoreSceneBvh(scene, nodes, {0}));
}

// Where all triangles are the same, boxes cannot tell.
TEST(RestoreBvh, RefusesATriangleOfTwoLeaves) {
    Scene scene;
    addSurface(scene, lambert(0.5f));
    for (int i = 0; i < 50; ++i)
        addTriangle(scene, std::array{glm::vec3(0), glm::vec3(1, 0, 0), glm::vec3(0, 1, 0)}, kNoUvs);
    const SceneBvh built = buildSceneBvh(scene);
    int damages = 0;
    for (size_t i = 0; i < built.nodes.size(); ++i) {
        const NodeChildren children = unpackNode(built.nodes[i]);
        uint32_t end = children.firstTriangle;
        for (const uint32_t count : children.leafTriangles) end += count;
        const int last = children.count - 1;
        const uint32_t count = children.leafTriangles[size_t(last)];
        if (count == 0 || count == kMaxLeafTriangles || end == scene.triangles.size()) continue;
        ++damages;
        SceneBvh damaged = built;
        damaged.nodes[i].words[10] += 1u << (2 * last);
        EXPECT_FALSE(restores(scene, damaged)) << i;
    }
    EXPECT_GT(damages, 0);
}

// Whatever bits are wrong: it ends, and what it accepts is whole.
TEST(RestoreBvh, SurvivesRandomDamage) {
    const Scene scene = roomOfSpheres(4);
    const SceneBvh built = buildSceneBvh(scene);
    Rng rng(95);
    int refused = 0;
    for (int i = 0; i < 3000; ++i) {
        SceneBvh damaged = built;
        for (uint32_t change = 0; change <= rng.bits() % 3; ++change) {
            const uint32_t bit = 1u << rng.bits() % 32;
            if (rng.uniform() < 0.9f)
                damaged.nodes[rng.bits() % damaged.nodes.size()].words[rng.bits() % 12] ^= bit;
            else
                damaged.order[rng.bits() % damaged.order.size()] ^= bit;
        }
        const auto restored = restoreSceneBvh(scene, damaged.nodes, damaged.order);
        refused += !restored;
        if (!restored) continue;
        for (const BvhGroup& group : restored->groups) ASSERT_LE(group.stackWords, kGroupStackWords);
    }
    EXPECT_GT(refused, 1000);
    EXPECT_LT(refused, 3000);  // larger boxes are boxes, too
}

}  // namespace
}  // namespace phat::test
