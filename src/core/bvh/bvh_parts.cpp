#include "core/bvh/bvh_parts.h"

#include <map>

namespace phat {

std::vector<BvhPart> bvhParts(const Scene& scene) {
    std::map<std::pair<bool, uint32_t>, BvhPart> parts;
    for (const Surface& surface : scene.surfaces) {
        if (surface.triangleCount == 0) continue;
        const bool transparent = scene.materials[surface.material].alphaMode != AlphaMode::opaque;
        BvhPart& part = parts[{transparent, surface.node}];
        part.gltfNode = surface.node;
        part.transparent = transparent;
        for (uint32_t t = 0; t < surface.triangleCount; ++t)
            part.triangles.push_back(surface.firstTriangle + t);
    }
    std::vector<BvhPart> inOrder;
    for (auto& [key, part] : parts) inOrder.push_back(std::move(part));
    return inOrder;
}

}  // namespace phat
