#pragma once
// How a scene's triangles are put into groups, each of which gets a tree of its own.

#include <vector>

#include "core/scene/scene.h"

namespace phat {

/// The triangles of one glTF node that are opaque, or those that are not.
struct BvhPart {
    uint32_t gltfNode = 0;
    bool transparent = false;
    std::vector<uint32_t> triangles;  // Scene's, ascending
};

/// Opaque parts, then transparent ones, each by their node.
std::vector<BvhPart> bvhParts(const Scene& scene);

}  // namespace phat
