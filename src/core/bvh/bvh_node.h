#pragma once
// A node of the tree that shaders traverse: 48 bytes, three texels.
// twin: shaders/lib/bvh.glsl.

#include <array>
#include <vector>

#include "core/bvh/wide_tree.h"

namespace phat {

/// Words:
///   0-2   origin of the children's boxes (floats)
///   3     exponents of the boxes' units by axis, with a bias of 127, 8 bits each; above them how many
///         children are inner nodes, or kInstance
///   4-9   low x, low y, low z, high x, high y, high z: 8 bits a child, in units from the origin
///   10    first inner child << 8 | 2 bits a child: the triangles of a leaf, less one; 0 for inner nodes
///   11    first triangle; the leaves' triangles lie one after the other
/// Inner children come first and have indices one after the other. The box of a child that is not there is
/// turned inside out, so that nothing meets it.
///
/// Of an instance: 0: root of the group, 1: whether the motion mirrors, 2: index of a node whose twelve words
/// are the rows of the matrix that takes world space to the group's space at rest (floats).
struct BvhNode {
    std::array<uint32_t, 12> words{};

    bool operator==(const BvhNode&) const = default;
};
static_assert(sizeof(BvhNode) == 48);

inline constexpr uint32_t kInstance = 255;
inline constexpr uint32_t kMaxLeafTriangles = 4;
/// Bits of a node's index.
inline constexpr int kBvhIndexBits = 24;

struct NodeChildren {
    std::array<Bounds, kBvhWidth> boxes;              // inner nodes, then leaves
    std::array<uint32_t, kBvhWidth> leafTriangles{};  // 0: an inner node
    int count = 0;
    uint32_t firstInner = 0;
    uint32_t firstTriangle = 0;
};

/// The boxes are rounded outwards. pre: as NodeChildren and the constants say.
BvhNode packNode(const NodeChildren& children);
/// With the boxes as they are stored.
NodeChildren unpackNode(const BvhNode& node);

inline bool isInstance(const BvhNode& node) {
    return node.words[3] >> 24 == kInstance;
}

/// A node without children.
BvhNode emptyNode();

/// What takes rays into the space of a group that has been moved.
struct BvhInstance {
    uint32_t root = 0;
    uint32_t matrixNode = 0;
    bool mirrored = false;  // the motion turns fronts into backs

    static BvhInstance of(const BvhNode& node);
};
BvhNode packInstance(const BvhInstance& instance);
/// Rows of an affine matrix.
BvhNode packMatrix(const glm::mat4& restFromWorld);

}  // namespace phat
