#include "core/bvh/wide_tree.h"

#include <gtest/gtest.h>

#include <set>

#include "support/ray_scenes.h"

namespace phat::test {
namespace {

std::vector<Bounds> randomBoxes(int count, uint64_t seed) {
    Rng rng(seed);
    std::vector<Bounds> boxes{size_t(count)};
    for (Bounds& box : boxes) {
        const glm::vec3 center = randomPoint(rng);
        box.add(center + 0.1f * randomPoint(rng));
        box.add(center + 0.1f * randomPoint(rng));
    }
    return boxes;
}

// Boxes each of which is far larger than all before: the heuristic takes them off one by one.
std::vector<Bounds> growingBoxes(int count) {
    std::vector<Bounds> boxes;
    for (int i = 0; i < count; ++i) {
        const float at = std::exp2(float(i) - 60);
        boxes.push_back({glm::vec3(at), glm::vec3(1.5f * at)});
    }
    return boxes;
}

bool contains(const Bounds& outer, const Bounds& inner) {
    return outer.low == glm::min(outer.low, inner.low) && outer.high == glm::max(outer.high, inner.high);
}

int depthOf(const BinaryTree& tree, uint32_t node) {
    if (tree.nodes[node].isLeaf()) return 0;
    return 1 + std::max(depthOf(tree, node + 1), depthOf(tree, tree.nodes[node].right));
}

void expectIsTree(const BinaryTree& tree, const std::vector<Bounds>& boxes) {
    std::set<uint32_t> seen(tree.order.begin(), tree.order.end());
    EXPECT_EQ(seen.size(), boxes.size());
    for (uint32_t i = 0; i < tree.nodes.size(); ++i) {
        const BinaryNode& node = tree.nodes[i];
        for (uint32_t k = node.first; k < node.first + node.count; ++k)
            ASSERT_TRUE(contains(node.bounds, boxes[tree.order[k]]));
        if (node.isLeaf()) continue;
        const BinaryNode &left = tree.nodes[i + 1], &right = tree.nodes[node.right];
        ASSERT_GT(node.right, i + 1);
        ASSERT_EQ(left.first, node.first);
        ASSERT_EQ(right.first, left.first + left.count);
        ASSERT_EQ(left.count + right.count, node.count);
    }
}

TEST(BinaryTree, HoldsEachBoxOnce) {
    for (const int count : {1, 2, 3, 7, 500, 20000}) {
        const auto boxes = randomBoxes(count, 41);
        expectIsTree(buildBinaryTree(boxes, 64), boxes);
    }
    // Many boxes with one centre.
    const std::vector<Bounds> same(1000, Bounds{glm::vec3(-1), glm::vec3(1)});
    expectIsTree(buildBinaryTree(same, 64), same);
}

TEST(BinaryTree, StaysWithinItsDepth) {
    const auto boxes = growingBoxes(100);
    const BinaryTree deep = buildBinaryTree(boxes, 64), flat = buildBinaryTree(boxes, 7);
    expectIsTree(deep, boxes);
    expectIsTree(flat, boxes);
    EXPECT_GT(depthOf(deep, 0), 20);
    EXPECT_LE(depthOf(flat, 0), 7);
}

double costOf(const BinaryTree& binary, const std::vector<WideNode>& wide, const WideCosts& costs) {
    double cost = 0;
    uint32_t binaryRoot = 0;
    std::vector<uint32_t> binaryOf(wide.size(), binaryRoot);
    for (size_t i = 0; i < wide.size(); ++i) {
        cost += double(halfArea(binary.nodes[binaryOf[i]].bounds)) * costs.node;
        for (int child = 0; child < wide[i].childCount; ++child) {
            const uint32_t below = wide[i].children[size_t(child)];
            if (child < wide[i].innerCount)
                binaryOf[wide[i].firstInner + uint32_t(child)] = below;
            else
                cost += double(halfArea(binary.nodes[below].bounds)) * binary.nodes[below].count *
                        costs.primitive;
        }
    }
    return cost;
}

// Opens the child of the largest area until the node is full, as is usual: leaves of one box.
double greedyCost(const BinaryTree& tree, uint32_t node, const WideCosts& costs) {
    std::vector<uint32_t> children{node + 1, tree.nodes[node].right};
    while (children.size() < kBvhWidth) {
        int largest = -1;
        for (int i = 0; i < int(children.size()); ++i) {
            const auto area = [&](int child) { return halfArea(tree.nodes[children[size_t(child)]].bounds); };
            if (!tree.nodes[children[size_t(i)]].isLeaf() && (largest < 0 || area(i) > area(largest)))
                largest = i;
        }
        if (largest < 0) break;
        const uint32_t opened = children[size_t(largest)];
        children[size_t(largest)] = opened + 1;
        children.push_back(tree.nodes[opened].right);
    }
    double cost = double(halfArea(tree.nodes[node].bounds)) * costs.node;
    for (const uint32_t child : children)
        cost += tree.nodes[child].isLeaf() ? double(halfArea(tree.nodes[child].bounds)) * costs.primitive
                                           : greedyCost(tree, child, costs);
    return cost;
}

TEST(WideTree, HoldsEachBoxOnceAndCostsLessThanAGreedyOne) {
    for (const int count : {2, 3, 4, 5, 9, 100, 5000}) {
        const auto boxes = randomBoxes(count, 42);
        const BinaryTree binary = buildBinaryTree(boxes, 64);
        for (const uint32_t maxLeaf : {1u, 4u}) {
            const WideCosts costs{.maxLeaf = maxLeaf};
            const auto wide = makeWideTree(binary, costs);
            std::vector<int> held(boxes.size(), 0);
            std::vector<int> parents(wide.size(), 0);
            for (uint32_t i = 0; i < wide.size(); ++i) {
                ASSERT_LE(wide[i].innerCount, wide[i].childCount);
                for (int child = 0; child < wide[i].childCount; ++child) {
                    const BinaryNode& below = binary.nodes[wide[i].children[size_t(child)]];
                    if (child < wide[i].innerCount) {
                        ASSERT_GT(wide[i].firstInner + uint32_t(child), i);
                        ++parents[wide[i].firstInner + uint32_t(child)];
                        continue;
                    }
                    ASSERT_LE(below.count, maxLeaf);
                    for (uint32_t k = 0; k < below.count; ++k) ++held[binary.order[below.first + k]];
                }
            }
            EXPECT_EQ(std::count(held.begin(), held.end(), 1), count);
            EXPECT_EQ(std::count(parents.begin() + 1, parents.end(), 1), int(wide.size()) - 1);
            EXPECT_LE(costOf(binary, wide, costs), greedyCost(binary, 0, costs) * (1 + 1e-5)) << count;
        }
    }
}

// Clumps each of which is far larger than all before: in the best tree each level has one, and the rest.
TEST(WideTree, OfAnyShapeStaysWithinTheStack) {
    std::vector<Bounds> boxes;
    Rng rng(43);
    for (int clump = 0; clump < 40; ++clump) {
        const float size = std::exp2(float(clump) - 20);
        for (int i = 0; i < 12; ++i) {
            const glm::vec3 at = size * (1.0f + 0.3f * randomPoint(rng));
            boxes.push_back({at, at + 0.1f * size});
        }
    }
    const BoxTree best = buildBoxTree(boxes, {}, LeafVisits::none, 100);
    const BoxTree within = buildBoxTree(boxes, {}, LeafVisits::none, 9);
    EXPECT_GT(best.stackWords, 9);
    EXPECT_LE(within.stackWords, 9);  // 480 boxes
    EXPECT_EQ(within.stackWords, stackWords(within.wide, LeafVisits::none));
    expectIsTree(within.binary, boxes);
}

TEST(WideTree, OfOneBoxIsOneNode) {
    const std::vector<Bounds> one{Bounds{glm::vec3(0), glm::vec3(1)}};
    const auto wide = makeWideTree(buildBinaryTree(one, 0), {});
    ASSERT_EQ(wide.size(), 1u);
    EXPECT_EQ(wide[0].childCount, 1);
    EXPECT_EQ(wide[0].innerCount, 0);
    EXPECT_EQ(stackWords(wide, LeafVisits::none), 0);
}

TEST(WideTree, StackWordsAreThoseOfTheDeepestPath) {
    // A root with two inner nodes; the first has two, of which one has one, with leaves below.
    std::vector<WideNode> tree(6);
    tree[0] = {{}, 2, 3, 1};
    tree[1] = {{}, 2, 2, 3};
    tree[2] = {{}, 0, 4, 0};
    tree[3] = {{}, 1, 1, 5};
    tree[4] = {{}, 0, 1, 0};
    tree[5] = {{}, 0, 4, 0};
    EXPECT_EQ(stackWords(tree, LeafVisits::none), 2);
    EXPECT_EQ(stackWords(tree, LeafVisits::later), 3);
}

}  // namespace
}  // namespace phat::test
