#include "core/bvh/restore_bvh.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/bvh/bvh_parts.h"
#include "core/scene/triangle_corners.h"

namespace phat {
namespace {

// Whether a traversal can read the node: no instance, finite boxes.
bool isReadable(const BvhNode& node) {
    if (node.words[3] >> 24 > uint32_t(kBvhWidth)) return false;
    for (int axis = 0; axis < 3; ++axis) {
        const uint32_t exponent = node.words[3] >> (8 * axis) & 255;
        const float origin = std::bit_cast<float>(node.words[size_t(axis)]);
        if (exponent == 0 || exponent == 255 || !(std::abs(origin) <= kMaxCoordinate)) return false;
    }
    return true;
}

/// Walks through the groups' trees; all of them must be walked through before it says that they are whole.
class Walk {
  public:
    explicit Walk(const SceneBvh& bvh)
        : bvh_(bvh), nodeSeen_(bvh.nodes.size(), false), triangleSeen_(bvh.triangles.size(), false) {}

    // Sets the group's number of words. False where the tree is not one of the group's triangles.
    bool group(BvhGroup& group) {
        pending_ = {{group.root, {glm::vec3(-kFarDistance), glm::vec3(kFarDistance)}, 0}};
        if (!see(group.root)) return false;
        while (!pending_.empty()) {
            const Entry at = pending_.back();
            pending_.pop_back();
            if (!visit(group, at)) return false;
        }
        return group.stackWords <= kGroupStackWords;
    }
    bool whole() const {
        return std::find(nodeSeen_.begin(), nodeSeen_.end(), false) == nodeSeen_.end() &&
               std::find(triangleSeen_.begin(), triangleSeen_.end(), false) == triangleSeen_.end();
    }
    // The first node that no group has.
    uint32_t nextRoot() const { return nextRoot_; }

  private:
    struct Entry {
        uint32_t node;
        Bounds around;  // what all boxes above have in common
        int words;      // of the stack, on the way here
    };

    bool see(uint32_t node) {
        if (node >= nodeSeen_.size() || nodeSeen_[node]) return false;
        nodeSeen_[node] = true;
        nextRoot_ = std::max(nextRoot_, node + 1);
        return isReadable(bvh_.nodes[node]);
    }

    bool visit(BvhGroup& group, const Entry& at) {
        const BvhNode& node = bvh_.nodes[at.node];
        const NodeChildren children = unpackNode(node);
        const int innerCount = int(node.words[3] >> 24), words = at.words + (innerCount > 1);
        if (innerCount > children.count) return false;
        group.stackWords = std::max(group.stackWords, words);
        uint64_t triangle = children.firstTriangle;
        for (int child = 0; child < children.count; ++child) {
            const Bounds& box = children.boxes[size_t(child)];
            const Bounds both{glm::max(at.around.low, box.low), glm::min(at.around.high, box.high)};
            if (child < innerCount) {
                const uint32_t inner = children.firstInner + uint32_t(child);
                if (inner <= at.node || !see(inner)) return false;
                pending_.push_back({inner, both, words});
            }
            const uint32_t count = children.leafTriangles[size_t(child)];
            if (child >= innerCount && count == 0) return false;  // a gap among the children
            for (uint32_t i = 0; i < count; ++i)
                if (!seeTriangle(group, triangle++, both)) return false;
        }
        return true;
    }

    bool seeTriangle(BvhGroup& group, uint64_t index, const Bounds& inside) {
        if (index < group.firstTriangle || index >= uint64_t(group.firstTriangle) + group.triangleCount ||
            triangleSeen_[index])
            return false;
        triangleSeen_[index] = true;
        for (const glm::vec3& corner : cornersOf(bvh_.grid, bvh_.triangles[index])) {
            if (corner != glm::clamp(corner, inside.low, inside.high)) return false;
            group.bounds.add(corner);
        }
        return true;
    }

    const SceneBvh& bvh_;
    std::vector<bool> nodeSeen_, triangleSeen_;
    std::vector<Entry> pending_;
    uint32_t nextRoot_ = 0;
};

// The groups as the scene has them, without their trees. False where the order is not one of their triangles.
bool addGroups(const Scene& scene, SceneBvh& bvh) {
    uint32_t first = 0;
    for (const BvhPart& part : bvhParts(scene)) {
        const uint32_t count = uint32_t(part.triangles.size());
        if (count > bvh.order.size() - first) return false;
        std::vector<uint32_t> triangles(bvh.order.begin() + first, bvh.order.begin() + first + count);
        std::sort(triangles.begin(), triangles.end());
        if (triangles != part.triangles) return false;
        bvh.groups.push_back({part.gltfNode, 0, first, count, 0, {}});
        first += count;
        if (!part.transparent) bvh.firstTransparent = first;
    }
    return first == bvh.order.size();
}

}  // namespace

std::optional<SceneBvh> restoreSceneBvh(const Scene& scene, std::vector<BvhNode> nodes,
                                        std::vector<uint32_t> order) {
    if (!canHaveBvh(scene) || order.size() != scene.triangles.size() || nodes.size() >= 1u << kBvhIndexBits)
        return std::nullopt;
    SceneBvh bvh;
    bvh.nodes = std::move(nodes);
    bvh.order = std::move(order);
    bvh.grid = gridOver(scene.positions);
    if (!addGroups(scene, bvh)) return std::nullopt;
    bvh.triangles.reserve(bvh.order.size());
    for (const uint32_t triangle : bvh.order)
        bvh.triangles.push_back(packTriangle(bvh.grid, cornersOf(scene, triangle)));
    Walk walk(bvh);
    for (BvhGroup& group : bvh.groups) {
        group.root = walk.nextRoot();
        if (!walk.group(group)) return std::nullopt;
    }
    if (!walk.whole()) return std::nullopt;
    return bvh;
}

}  // namespace phat
