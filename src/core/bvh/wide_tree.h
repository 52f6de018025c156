#pragma once
// A bounding volume hierarchy of four children a node, cut out of a binary one.

#include <array>
#include <vector>

#include "core/bvh/binary_tree.h"

namespace phat {

inline constexpr int kBvhWidth = 4;

struct WideNode {
    /// Nodes of the binary tree: first `innerCount` inner ones, then leaves, `childCount` in all. A leaf has
    /// all boxes below its node.
    std::array<uint32_t, kBvhWidth> children{};
    int innerCount = 0;
    int childCount = 0;
    uint32_t firstInner = 0;  // WideNode of the first inner child; the others follow
};

/// What the tree is made for. A node is three texels and a triangle two: in that ratio a ray reads least, and
/// in this one, with 1 % more reads at most, the trees of five scenes take less than 40 bytes a triangle,
/// which is what it was tuned on.
struct WideCosts {
    float node = 4;           // to visit a node
    float primitive = 1.25f;  // to test what is in one box
    uint32_t maxLeaf = 4;     // boxes
};

/// The wide tree of least expected cost over all that are made by leaving nodes of the binary tree out.
/// source: Ylitie, Karras and Laine 2017, "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide
/// BVHs", section 4.1. Node 0 is the root; children come after their parents.
std::vector<WideNode> makeWideTree(const BinaryTree& tree, const WideCosts& costs);

/// Whether a traversal comes back for leaves, too, because they stand for trees of their own.
enum class LeafVisits : uint8_t { none, later };

/// The most words that the stack of a traversal holds at a time: one for each level at which more than one
/// child can be left to visit.
int stackWords(const std::vector<WideNode>& tree, LeafVisits leaves);

/// A wide tree with the binary one that it was cut out of.
struct BoxTree {
    BinaryTree binary;
    std::vector<WideNode> wide;
    int stackWords = 0;
};

/// The best tree or, where that needs more than `maxStackWords`, a balanced one, which needs no more than the
/// logarithm of the number of boxes to base 2. pre: as of buildBinaryTree.
BoxTree buildBoxTree(std::span<const Bounds> boxes, const WideCosts& costs, LeafVisits leaves,
                     int maxStackWords);

}  // namespace phat
