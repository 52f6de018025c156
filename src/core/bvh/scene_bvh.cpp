#include "core/bvh/scene_bvh.h"

#include <algorithm>
#include <map>
#include <stdexcept>

#include "core/base/parallel.h"

namespace phat {
namespace {

/// No more of the stack goes to one group; the tree over the groups has the rest. A balanced tree of
/// kMaxBvhTriangles has no more levels.
constexpr int kGroupStackWords = 23;

/// What becomes a group.
struct Part {
    uint32_t gltfNode = 0;
    std::vector<uint32_t> triangles;
};

/// A group's tree, with indices from 0.
struct PartTree {
    std::vector<BvhNode> nodes;
    std::vector<uint32_t> order;  // of Part::triangles
    int stackWords = 0;
    Bounds bounds;
};

// Opaque parts, then transparent ones, each by their node.
std::vector<Part> partsOf(const Scene& scene) {
    std::map<std::pair<bool, uint32_t>, Part> parts;
    for (const Surface& surface : scene.surfaces) {
        if (surface.triangleCount == 0) continue;
        const bool transparent = scene.materials[surface.material].alphaMode != AlphaMode::opaque;
        Part& part = parts[{transparent, surface.node}];
        part.gltfNode = surface.node;
        for (uint32_t t = 0; t < surface.triangleCount; ++t)
            part.triangles.push_back(surface.firstTriangle + t);
    }
    std::vector<Part> inOrder;
    for (auto& [key, part] : parts) inOrder.push_back(std::move(part));
    return inOrder;
}

bool isTransparent(const Scene& scene, const Part& part) {
    return scene.materialOf(part.triangles[0]).alphaMode != AlphaMode::opaque;
}

std::array<glm::vec3, 3> cornersAt(const Scene& scene, uint32_t triangle) {
    const glm::uvec3 t = scene.triangles[triangle];
    return {scene.positions[t.x], scene.positions[t.y], scene.positions[t.z]};
}

// Boxes of the triangles as they are stored.
std::vector<Bounds> boxesOf(const Scene& scene, const BvhGrid& grid, const Part& part) {
    std::vector<Bounds> boxes(part.triangles.size());
    for (size_t i = 0; i < boxes.size(); ++i)
        for (const glm::vec3& corner :
             cornersOf(grid, packTriangle(grid, cornersAt(scene, part.triangles[i]))))
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

void append(SceneBvh& bvh, const Part& part, const PartTree& tree) {
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

SceneBvh buildSceneBvh(const Scene& scene) {
    if (scene.triangles.size() > kMaxBvhTriangles || scene.surfaces.size() > kMaxBvhGroups)
        throw std::length_error("the scene has too many triangles or surfaces for rays on the GPU");
    SceneBvh bvh;
    bvh.grid = gridOver(scene.positions);
    const std::vector<Part> parts = partsOf(scene);
    std::vector<PartTree> trees(parts.size());
    SilentProgress none;
    parallelRanges(parts.size(), 1, none, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) trees[i] = treeOf(boxesOf(scene, bvh.grid, parts[i]));
    });
    for (size_t i = 0; i < parts.size(); ++i) {
        append(bvh, parts[i], trees[i]);
        if (!isTransparent(scene, parts[i])) bvh.firstTransparent = uint32_t(bvh.order.size());
    }
    bvh.triangles.reserve(bvh.order.size());
    for (const uint32_t triangle : bvh.order)
        bvh.triangles.push_back(packTriangle(bvh.grid, cornersAt(scene, triangle)));
    return bvh;
}

}  // namespace phat
