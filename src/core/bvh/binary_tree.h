#pragma once
// A binary bounding volume hierarchy over boxes, of which wide_tree.h makes a wide one.

#include <span>
#include <vector>

#include "core/scene/scene.h"

namespace phat {

struct BinaryNode {
    Bounds bounds;
    uint32_t first = 0;  // of BinaryTree::order: the boxes below are `count` entries from here
    uint32_t count = 0;
    uint32_t right = 0;  // index of the second child; the first follows its parent. Of a single box: 0

    bool isLeaf() const { return count == 1; }
};

/// Node 0 is the root; children come after their parents. Leaves are single boxes.
struct BinaryTree {
    std::vector<BinaryNode> nodes;  // 2 n - 1
    std::vector<uint32_t> order;    // indices of boxes
};

/// More levels than a tree has that is worth traversing.
inline constexpr int kMaxTreeDepth = 64;

/// Splits where the surface area heuristic, evaluated at the borders of bins, is least; from where only a
/// balanced tree stays within `maxDepth` levels below the root, in halves of equal count. The same on any
/// number of threads. source: Wald 2007, "On fast Construction of SAH-based Bounding Volume Hierarchies".
/// pre: boxes are not empty, and there are at least one and at most 2^maxDepth.
BinaryTree buildBinaryTree(std::span<const Bounds> boxes, int maxDepth);

/// Half of the surface area.
float halfArea(const Bounds& bounds);

}  // namespace phat
