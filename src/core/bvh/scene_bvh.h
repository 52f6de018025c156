#pragma once
// The trees of a scene at rest, as they lie on the GPU: one for each group of triangles that moves as one.

#include <optional>
#include <vector>

#include "core/bvh/bvh_node.h"
#include "core/bvh/bvh_triangle.h"

namespace phat {

/// The triangles of one glTF node, the only things that move apart; its transparent ones are a group of
/// their own.
struct BvhGroup {
    uint32_t gltfNode = 0;
    uint32_t root = 0;           // its first node
    uint32_t firstTriangle = 0;  // in the order of the leaves
    uint32_t triangleCount = 0;
    int stackWords = 0;
    Bounds bounds;
};

/// Opaque groups come first.
struct SceneBvh {
    std::vector<BvhNode> nodes;
    std::vector<BvhTriangle> triangles;  // in the order of the leaves
    std::vector<uint32_t> order;         // [triangle]: Scene's
    std::vector<BvhGroup> groups;
    BvhGrid grid;
    uint32_t firstTransparent = 0;  // triangles from here on let rays pass, see transparency.h
};

/// Words of the stack of a traversal. twin: shaders/lib/bvh.glsl.
inline constexpr int kBvhStackWords = 32;
/// No more of them go to one group; the tree over the groups has the rest. A balanced tree of
/// kMaxBvhTriangles has no more levels.
inline constexpr int kGroupStackWords = 23;
inline constexpr uint32_t kMaxBvhTriangles = 1u << 23;
inline constexpr uint32_t kMaxBvhGroups = 1u << 20;

/// Of the scene at rest. To be built again when a material gets or loses its transparency, not when things
/// move. The same bytes on any number of threads. Throws std::length_error before it takes memory where the
/// scene exceeds the limits.
SceneBvh buildSceneBvh(const Scene& rest);
/// Whether it is within the limits.
bool canHaveBvh(const Scene& scene);
/// The trees in `known`, which are built first where there are none; null where the scene exceeds the limits.
const SceneBvh* bvhOf(const Scene& rest, std::optional<SceneBvh>& known);

}  // namespace phat
