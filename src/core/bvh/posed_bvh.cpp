#include "core/bvh/posed_bvh.h"

#include <algorithm>
#include <glm/gtc/matrix_inverse.hpp>
#include <stdexcept>

#include "core/scene/scene_motion.h"

namespace phat {
namespace {

/// Of a moved box, over the terms that its coordinates are sums of: four roundings on the way there and as
/// many of the ray on the way back, and as much again.
constexpr float kMotionRounding = 16 * 0x1p-24f;

struct Placed {
    uint32_t group = 0;
    glm::mat4 worldFromRest{1};
    glm::mat4 restFromWorld{1};

    bool isMoved() const { return worldFromRest != glm::mat4(1); }
};

Bounds movedBounds(const Bounds& bounds, const Placed& placed) {
    if (!placed.isMoved()) return bounds;
    Bounds moved;
    for (int corner = 0; corner < 8; ++corner) {
        const glm::vec3 at(corner & 1 ? bounds.high.x : bounds.low.x,
                           corner & 2 ? bounds.high.y : bounds.low.y,
                           corner & 4 ? bounds.high.z : bounds.low.z);
        moved.add(movedPoint(placed.worldFromRest, at));
    }
    const glm::mat4& m = placed.worldFromRest;
    const glm::vec3 largest = glm::max(glm::abs(bounds.low), glm::abs(bounds.high));
    const glm::vec3 terms =
        glm::abs(m[0]) * largest.x + glm::abs(m[1]) * largest.y + glm::abs(m[2]) * largest.z + glm::abs(m[3]);
    const glm::vec3 margin = kMotionRounding * terms;
    return {moved.low - margin, moved.high + margin};
}

std::vector<Placed> placedGroups(const SceneBvh& bvh, std::span<const glm::mat4> worldFromRest) {
    std::vector<Placed> placed;
    for (uint32_t i = 0; i < bvh.groups.size(); ++i) {
        const glm::mat4 m = matrixAt(worldFromRest, bvh.groups[i].gltfNode);
        const glm::mat4 inverse = glm::affineInverse(m);
        bool finite = true;
        for (int column = 0; column < 4; ++column)
            for (int row = 0; row < 3; ++row) finite &= std::isfinite(inverse[column][row]);
        if (finite) placed.push_back({i, m, inverse});
    }
    return placed;
}

/// Writes a wide tree over the groups.
class Packer {
  public:
    Packer(const SceneBvh& bvh, const std::vector<Placed>& placed) : bvh_(bvh), placed_(placed) {}

    PosedBvh pack(const BinaryTree& binary, const std::vector<WideNode>& wide) {
        addNodes(1);
        if (binary.nodes.size() == 1)
            place(0, binary.order[0]);
        else
            packBelow(binary, wide, 0, 0);
        posed_.root = indexOf(0);
        return std::move(posed_);
    }

  private:
    uint32_t indexOf(uint32_t posedNode) const { return uint32_t(bvh_.nodes.size()) + posedNode; }

    uint32_t addNodes(int count) {
        const uint32_t first = uint32_t(posed_.nodes.size());
        posed_.nodes.resize(posed_.nodes.size() + size_t(count));
        return first;
    }

    // A wide node's children follow each other, inner nodes first, then groups.
    void packBelow(const BinaryTree& binary, const std::vector<WideNode>& wide, uint32_t wideNode,
                   uint32_t at) {
        const WideNode& node = wide[wideNode];
        const uint32_t first = addNodes(node.childCount);
        NodeChildren children;
        children.count = node.childCount;
        children.firstInner = indexOf(first);
        for (int child = 0; child < node.childCount; ++child)
            children.boxes[size_t(child)] = binary.nodes[node.children[size_t(child)]].bounds;
        posed_.nodes[at] = packNode(children);
        for (int child = 0; child < node.childCount; ++child) {
            if (child < node.innerCount)
                packBelow(binary, wide, node.firstInner + uint32_t(child), first + uint32_t(child));
            else
                place(first + uint32_t(child),
                      binary.order[binary.nodes[node.children[size_t(child)]].first]);
        }
    }

    void place(uint32_t at, uint32_t placedIndex) {
        const Placed& placed = placed_[placedIndex];
        const uint32_t root = bvh_.groups[placed.group].root;
        if (!placed.isMoved()) {
            posed_.nodes[at] = bvh_.nodes[root];
            return;
        }
        const uint32_t matrix = addNodes(1);
        posed_.nodes[matrix] = packMatrix(placed.restFromWorld);
        posed_.nodes[at] =
            packInstance({root, indexOf(matrix), glm::determinant(glm::mat3(placed.worldFromRest)) < 0});
    }

    const SceneBvh& bvh_;
    const std::vector<Placed>& placed_;
    PosedBvh posed_;
};

}  // namespace

uint32_t maxPosedNodes(const SceneBvh& bvh) {
    // Each group has a node and a matrix, and inner nodes have two children or more.
    return std::max(uint32_t(3 * bvh.groups.size()), 1u);
}

PosedBvh poseBvh(const SceneBvh& bvh, std::span<const glm::mat4> worldFromRest) {
    const std::vector<Placed> placed = placedGroups(bvh, worldFromRest);
    if (placed.empty()) return {{emptyNode()}, uint32_t(bvh.nodes.size())};
    std::vector<Bounds> boxes;
    int groupWords = 0;
    for (const Placed& one : placed) {
        const BvhGroup& group = bvh.groups[one.group];
        boxes.push_back(movedBounds(group.bounds, one));
        groupWords = std::max(groupWords, group.stackWords);
    }
    // A group costs a visit of its root, whether it is a leaf here or not.
    const WideCosts costs{.primitive = WideCosts{}.node, .maxLeaf = 1};
    const int wordsLeft = kBvhStackWords - groupWords;
    const BoxTree tree = buildBoxTree(boxes, costs, LeafVisits::later, wordsLeft);
    if (tree.stackWords > wordsLeft)
        throw std::length_error("the scene has too many nodes for rays on the GPU");
    return Packer(bvh, placed).pack(tree.binary, tree.wide);
}

}  // namespace phat
