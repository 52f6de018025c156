#include "io/gltf/same_surfaces.h"

#include <algorithm>
#include <map>

#include "core/base/fingerprint.h"
#include "io/gltf/gltf_json.h"

namespace phat {
namespace {

// Placements whose scales differ by less than this are the same but for rounding: texels stay as large.
constexpr double kScaleTolerance = 1e-5;

/// What must be equal for a surface to be the same.
struct SurfaceShape {
    uint64_t triangles = 0;  // fingerprint of the corners, in the node's space
    glm::dmat3 scale{0};     // what remains of the placement without its rotation: its Gram matrix
    bool mirrored = false;
};

bool sameShape(const SurfaceShape& a, const SurfaceShape& b) {
    if (a.triangles != b.triangles || a.mirrored != b.mirrored) return false;
    double largest = 0, difference = 0;
    for (int i = 0; i < 9; ++i) {
        largest = std::max(largest, std::abs(a.scale[i / 3][i % 3]));
        difference = std::max(difference, std::abs(a.scale[i / 3][i % 3] - b.scale[i / 3][i % 3]));
    }
    return difference <= kScaleTolerance * largest;
}

uint64_t trianglesOf(const SourcedScene& of, const Surface& surface) {
    const SurfaceCorners corners = surfaceCorners(of.source, of.scene, surface);
    const nlohmann::json& primitive =
        gltfItem(of.source.json, "meshes", surface.mesh).at("primitives").at(surface.primitive);
    const std::vector<float> positions = gltf::accessorFloats(
        of.source, wholeNumber(primitive.at("attributes"), "POSITION"), 3, false, corners.vertexCount);
    std::vector<float> all;
    all.reserve(9 * corners.vertices.size());
    for (const auto& triangle : corners.vertices)
        for (const uint32_t vertex : triangle)
            for (size_t axis = 0; axis < 3; ++axis)
                all.push_back(positions[3 * size_t(vertex) + axis] + 0.0f);  // -0 becomes 0
    Fingerprint fingerprint;
    fingerprint.addAll(all);
    return fingerprint.value();
}

/// The surfaces of a node.
struct NodeSurfaces {
    uint32_t node = 0;
    std::vector<uint32_t> surfaces;
    bool taken = false;
};

/// A file's surfaces with their shapes, by nodes in the order of their first surfaces.
struct Shapes {
    explicit Shapes(const SourcedScene& of) : scene(of.scene) {
        worldFromNode = worldFromNodes(scene.nodes, nullptr, 0);
        std::map<uint32_t, size_t> index;
        for (uint32_t s = 0; s < scene.surfaces.size(); ++s) {
            const Surface& surface = scene.surfaces[s];
            const glm::dmat3 placement(worldFromNode.at(surface.node));
            shape.push_back({trianglesOf(of, surface), glm::transpose(placement) * placement,
                             glm::determinant(placement) < 0});
            const auto [at, isNew] = index.try_emplace(surface.node, nodes.size());
            if (isNew) nodes.push_back({surface.node, {}, false});
            nodes[at->second].surfaces.push_back(s);
        }
    }

    const Scene& scene;
    std::vector<glm::dmat4> worldFromNode;
    std::vector<SurfaceShape> shape;  // per surface
    std::vector<NodeSurfaces> nodes;
};

class Matcher {
  public:
    Matcher(const SourcedScene& now, const SourcedScene& before) : now_(now), before_(before) {
        for (size_t n = 0; n < now_.nodes.size(); ++n)
            for (const uint32_t s : now_.nodes[n].surfaces) {
                std::vector<size_t>& with = nodesWith_[now_.shape[s].triangles];
                if (with.empty() || with.back() != n) with.push_back(n);
            }
    }

    std::vector<uint32_t> match() {
        std::vector<uint32_t> result(now_.scene.surfaces.size(), kNewSurface);
        for (const auto& [name, place] :
             {std::pair(true, true), {false, true}, {true, false}, {false, false}})
            for (NodeSurfaces& before : before_.nodes)
                if (!before.taken) take(before, name, place, result);
        return result;
    }

  private:
    bool alike(uint32_t now, uint32_t before, bool name, bool place) const {
        return (!name || now_.scene.nodes[now].name == before_.scene.nodes[before].name) &&
               (!place || now_.worldFromNode[now] == before_.worldFromNode[before]);
    }

    void take(NodeSurfaces& before, bool name, bool place, std::vector<uint32_t>& result) {
        for (const uint32_t s : before.surfaces) {
            const auto found = nodesWith_.find(before_.shape[s].triangles);
            if (found == nodesWith_.end()) continue;
            for (const size_t n : found->second) {
                NodeSurfaces& now = now_.nodes[n];
                if (now.taken || !alike(now.node, before.node, name, place)) continue;
                if (!pair(now, before, result)) continue;
                now.taken = before.taken = true;
                return;
            }
        }
    }

    // Whether any surface of the nodes is the same.
    bool pair(const NodeSurfaces& now, const NodeSurfaces& before, std::vector<uint32_t>& result) const {
        bool any = false;
        for (const uint32_t b : before.surfaces)
            for (const uint32_t n : now.surfaces) {
                if (result[n] != kNewSurface || !sameShape(now_.shape[n], before_.shape[b])) continue;
                result[n] = b;
                any = true;
                break;
            }
        return any;
    }

    Shapes now_, before_;
    std::map<uint64_t, std::vector<size_t>> nodesWith_;  // of now_, by the triangles of their surfaces
};

}  // namespace

std::vector<uint32_t> sameSurfaces(const SourcedScene& now, const SourcedScene& before) {
    return Matcher(now, before).match();
}

}  // namespace phat
