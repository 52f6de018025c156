#include "core/scene/transparency.h"

#include <array>
#include <map>

namespace phat {
namespace {

/// Finds out whether triangles close a volume: each edge is run through as often in one direction as in the
/// other. Vertices are one where they have the same position.
class EdgeCount {
  public:
    void add(const Scene& scene, const Surface& surface) {
        for (uint32_t t = 0; t < surface.triangleCount; ++t) {
            const glm::uvec3 triangle = scene.triangles[surface.firstTriangle + t];
            for (int corner = 0; corner < 3; ++corner)
                add(indexOf(scene.positions[triangle[corner]]),
                    indexOf(scene.positions[triangle[(corner + 1) % 3]]));
        }
    }
    bool closed() const {
        return !balance_.empty() && std::all_of(balance_.begin(), balance_.end(),
                                                [](const auto& edge) { return edge.second == 0; });
    }

  private:
    void add(uint32_t from, uint32_t to) {
        if (from != to) balance_[{std::min(from, to), std::max(from, to)}] += from < to ? 1 : -1;
    }
    uint32_t indexOf(glm::vec3 p) {
        // Negative zero is zero.
        const std::array<float, 3> key{p.x + 0.0f, p.y + 0.0f, p.z + 0.0f};
        return index_.emplace(key, uint32_t(index_.size())).first->second;
    }

    std::map<std::array<float, 3>, uint32_t> index_;
    std::map<std::array<uint32_t, 2>, int> balance_;
};

bool mayBoundVolume(const Material& material) {
    return isGlass(material) && material.thickness > 0.0f;
}

}  // namespace

std::vector<Glass> glassOfSurfaces(const Scene& scene, const std::vector<Material>& materials) {
    std::vector<Glass> glass;
    if (std::none_of(materials.begin(), materials.end(), isGlass)) return glass;
    std::map<uint32_t, EdgeCount> nodes;
    for (const Surface& surface : scene.surfaces)
        if (mayBoundVolume(materials[surface.material])) nodes[surface.node].add(scene, surface);
    for (const Surface& surface : scene.surfaces) {
        const Material& material = materials[surface.material];
        if (mayBoundVolume(material) && nodes[surface.node].closed())
            glass.push_back(Glass::volume);
        else
            glass.push_back(isGlass(material) ? Glass::thin : Glass::none);
    }
    return glass;
}

}  // namespace phat
