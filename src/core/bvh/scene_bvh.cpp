#include "core/bvh/scene_bvh.h"

#include <algorithm>
#include <stdexcept>

#include "core/base/parallel.h"
#include "core/bvh/bvh_parts.h"
#include "core/scene/triangle_corners.h"

namespace phat {
namespace {

/// A group's tree, with indices from 0.
struct PartTree {
    std::vector<BvhNode> nodes;
    std::vector<uint32_t> order;  // of BvhPart::triangles
    int stackWords = 0;
    Bounds bounds;
};

// Boxes of the triangles as they are stored.
std::vector<Bounds> boxesOf(const Scene& scene, const BvhGrid& grid, const BvhPart& part) {
    std::vector<Bounds> boxes(part.triangles.size());
    for (size_t i = 0; i < boxes.size(); ++i)
        for (const glm::vec3& corner :
             cornersOf(grid, packTriangle(grid, cornersOf(scene, part.triangles[i]))))
            boxes[i].add(corner);
    return boxes;
}

void packTree(const BoxTree& built, PartTree& tree) {
    const auto& [binary, wide, words] = built;
    tree.nodes.reserve(wide.size());
    tree.order.reserve(binary.order.size());
    for (const WideNode& node : wide) {
        NodeChildren children;
        children.count = node.childCount;
        children.firstInner = node.firstInner;
        children.firstTriangle = uint32_t(tree.order.size());
        for (int child = 0; child < node.childCount; ++child) {
            const BinaryNode& below = binary.nodes[node.children[size_t(child)]];
            children.boxes[size_t(child)] = below.bounds;
            if (child < node.innerCount) continue;
            children.leafTriangles[size_t(child)] = below.count;
            for (uint32_t i = 0; i < below.count; ++i) tree.order.push_back(binary.order[below.first + i]);
        }
        tree.nodes.push_back(packNode(children));
    }
}

PartTree treeOf(std::span<const Bounds> boxes) {
    const WideCosts costs{.maxLeaf = kMaxLeafTriangles};
    const BoxTree built = buildBoxTree(boxes, costs, LeafVisits::none, kGroupStackWords);
    PartTree tree;
    packTree(built, tree);
    tree.stackWords = built.stackWords;
    tree.bounds = built.binary.nodes[0].bounds;
    return tree;
}

void append(SceneBvh& bvh, const BvhPart& part, const PartTree& tree) {
    const uint32_t firstNode = uint32_t(bvh.nodes.size()), firstTriangle = uint32_t(bvh.order.size());
    bvh.groups.push_back(
        {part.gltfNode, firstNode, firstTriangle, uint32_t(tree.order.size()), tree.stackWords, tree.bounds});
    for (BvhNode node : tree.nodes) {
        node.words[10] += firstNode << 8;
        node.words[11] += firstTriangle;
        bvh.nodes.push_back(node);
    }
    for (const uint32_t i : tree.order) bvh.order.push_back(part.triangles[i]);
}

}  // namespace

bool canHaveBvh(const Scene& scene) {
    return scene.triangles.size() <= kMaxBvhTriangles && scene.surfaces.size() <= kMaxBvhGroups;
}

SceneBvh buildSceneBvh(const Scene& scene) {
    if (!canHaveBvh(scene))
        throw std::length_error("the scene has too many triangles or surfaces for rays on the GPU");
    SceneBvh bvh;
    bvh.grid = gridOver(scene.positions);
    const std::vector<BvhPart> parts = bvhParts(scene);
    std::vector<PartTree> trees(parts.size());
    SilentProgress none;
    parallelRanges(parts.size(), 1, none, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) trees[i] = treeOf(boxesOf(scene, bvh.grid, parts[i]));
    });
    for (size_t i = 0; i < parts.size(); ++i) {
        append(bvh, parts[i], trees[i]);
        if (!parts[i].transparent) bvh.firstTransparent = uint32_t(bvh.order.size());
    }
    bvh.triangles.reserve(bvh.order.size());
    for (const uint32_t triangle : bvh.order)
        bvh.triangles.push_back(packTriangle(bvh.grid, cornersOf(scene, triangle)));
    return bvh;
}

const SceneBvh* bvhOf(const Scene& rest, std::optional<SceneBvh>& known) {
    if (!known && canHaveBvh(rest)) known = buildSceneBvh(rest);
    return known ? &*known : nullptr;
}

}  // namespace phat
