#include "io/gltf/gltf_flatten.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "core/scene/append_vertices.h"
#include "io/gltf/gltf_lights_cameras.h"
#include "io/gltf/gltf_materials.h"
#include "io/gltf/gltf_mesh.h"
#include "io/gltf/gltf_tangents.h"

namespace phat::gltf {
namespace {

// How a node's linear part acts on positions, normals and orientation.
struct Placement {
    glm::dmat4 worldFromNode;
    glm::dmat3 linear;
    glm::dmat3 normalMatrix;  // the inverse transpose times |determinant|: also defined for flattened nodes
    bool mirrored = false;
};

Placement placementOf(const glm::dmat4& worldFromNode) {
    Placement placement{worldFromNode, glm::dmat3(worldFromNode), {}, false};
    const glm::dmat3& m = placement.linear;
    placement.mirrored = glm::determinant(m) < 0;
    const double sign = placement.mirrored ? -1.0 : 1.0;
    placement.normalMatrix = glm::dmat3(sign * glm::cross(m[1], m[2]), sign * glm::cross(m[2], m[0]),
                                        sign * glm::cross(m[0], m[1]));
    return placement;
}

bool placeable(glm::dvec3 p) {
    for (int axis = 0; axis < 3; ++axis)
        if (!(std::abs(p[axis]) <= kMaxCoordinateMeters)) return false;
    return true;
}

// Unit vector, or zero when there is no direction.
glm::vec3 directionOf(glm::dvec3 v) {
    const double largest = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
    if (!(largest > 0) || !std::isfinite(largest)) return glm::vec3(0);
    return glm::vec3(glm::normalize(v / largest));
}

// By how much the node moves planes of the surface apart that have its normals: |linear^T n| for a normal n
// of the placed surface. The mean over its area. 1 for a surface without area.
float scaleAlongNormals(const MeshPart& part, const Placement& placement) {
    const glm::dmat3 transposed = glm::transpose(placement.linear);
    double area = 0, scaled = 0;
    for (const glm::uvec3& t : part.triangles) {
        const glm::dvec3 p = part.positions[t[0]];
        const glm::dvec3 normal =
            glm::cross(glm::dvec3(part.positions[t[1]]) - p, glm::dvec3(part.positions[t[2]]) - p);
        area += glm::length(normal);
        scaled += glm::length(transposed * normal);
    }
    return area > 0 && std::isfinite(scaled) ? float(scaled / area) : 1.0f;
}

// The part in world space; triangles with a corner that is nowhere are gone.
MeshPart placed(const MeshPart& local, const Placement& placement, Notes& notes) {
    MeshPart part = local;
    std::vector<bool> good(part.positions.size());
    for (size_t v = 0; v < part.positions.size(); ++v) {
        const glm::dvec3 p = placement.worldFromNode * glm::dvec4(local.positions[v], 1.0);
        good[v] = placeable(p);
        part.positions[v] = good[v] ? glm::vec3(p) : glm::vec3(0);
    }
    std::erase_if(part.triangles, [&](glm::uvec3 t) {
        const bool bad = !good[t[0]] || !good[t[1]] || !good[t[2]];
        notes.unplaceableTriangles += bad;
        return bad;
    });
    if (placement.mirrored) {
        for (glm::uvec3& t : part.triangles) std::swap(t[1], t[2]);
    }
    return part;
}

void placeNormals(MeshPart& part, const Placement& placement, Notes& notes) {
    std::vector<uint32_t> broken;
    for (uint32_t v = 0; v < part.normals.size(); ++v) {
        part.normals[v] = directionOf(placement.normalMatrix * glm::dvec3(part.normals[v]));
        if (part.normals[v] == glm::vec3(0)) broken.push_back(v);
    }
    if (broken.empty()) return;

    // Area-weighted mean of the triangles around. Vertices without any area take +Y: nothing shows them.
    std::vector<glm::dvec3> sums(part.normals.size(), glm::dvec3(0));
    for (const glm::uvec3& t : part.triangles) {
        const glm::dvec3 p = part.positions[t[0]];
        const glm::dvec3 area =
            glm::cross(glm::dvec3(part.positions[t[1]]) - p, glm::dvec3(part.positions[t[2]]) - p);
        for (int corner = 0; corner < 3; ++corner) sums[t[corner]] += area;
    }
    for (const uint32_t v : broken) {
        part.normals[v] = directionOf(sums[v]);
        if (part.normals[v] == glm::vec3(0)) {
            part.normals[v] = glm::vec3(0, 1, 0);
        } else {
            ++notes.repairedNormals;
        }
    }
}

void placeTangents(MeshPart& part, const Placement& placement, Notes& notes) {
    for (size_t v = 0; v < part.tangents.size(); ++v) {
        glm::vec4& tangent = part.tangents[v];
        if (tangent == glm::vec4(0)) continue;
        const glm::vec3 along = directionOf(placement.linear * glm::dvec3(tangent));
        if (along == glm::vec3(0)) {
            ++notes.repairedTangents;
            tangent = anyTangent(part.normals[v]);
            continue;
        }
        // cross(normal, tangent) does not follow a mirror, so the handedness has to.
        const float handedness = tangent.w < 0 ? -1.0f : 1.0f;
        tangent = glm::vec4(along, placement.mirrored ? -handedness : handedness);
    }
}

// Meshes whose normals point behind their triangles, turned inside out by an exporter, would be black. Single
// normals may do so on purpose, as on leaves that are shaded like the tree's crown.
void turnInvertedNormals(MeshPart& part, Notes& notes) {
    constexpr double kInverted = 0.95;  // of the triangles' corners
    size_t behind = 0;
    for (const glm::uvec3& t : part.triangles) {
        const glm::dvec3 p = part.positions[t[0]];
        const glm::dvec3 area =
            glm::cross(glm::dvec3(part.positions[t[1]]) - p, glm::dvec3(part.positions[t[2]]) - p);
        for (int corner = 0; corner < 3; ++corner)
            behind += glm::dot(area, glm::dvec3(part.normals[t[corner]])) < 0;
    }
    if (part.triangles.empty() || double(behind) < kInverted * 3.0 * double(part.triangles.size())) return;
    for (glm::vec3& normal : part.normals) normal = -normal;
    // cross(normal, tangent) turns, too.
    for (glm::vec4& tangent : part.tangents) tangent.w = -tangent.w;
    ++notes.turnedNormals;
}

void appendPart(Scene& scene, const MeshPart& part, Surface surface) {
    surface.firstTriangle = uint32_t(scene.triangles.size());
    surface.triangleCount = uint32_t(part.triangles.size());
    surface.firstVertex = uint32_t(scene.positions.size());
    surface.vertexCount = uint32_t(part.positions.size());
    for (const glm::uvec3& t : part.triangles) scene.triangles.push_back(t + surface.firstVertex);
    scene.triangleSurface.insert(scene.triangleSurface.end(), part.triangles.size(),
                                 uint32_t(scene.surfaces.size()));
    appendVertices(scene, part);
    scene.surfaces.push_back(std::move(surface));
}

std::string surfaceName(const tinygltf::Node& node, const tinygltf::Mesh& mesh, uint32_t index) {
    if (!node.name.empty()) return node.name;
    return mesh.name.empty() ? fmt::format("node {}", index) : mesh.name;
}

// Nodes with a mesh, those of one mesh together: each primitive is decoded once and not kept.
std::vector<const WorldNode*> instancesByMesh(const tinygltf::Model& model,
                                              const std::vector<WorldNode>& nodes) {
    std::vector<const WorldNode*> instances;
    for (const WorldNode& world : nodes)
        if (!world.hidden && model.nodes[world.node].mesh >= 0) instances.push_back(&world);
    std::stable_sort(instances.begin(), instances.end(), [&](const WorldNode* a, const WorldNode* b) {
        return model.nodes[a->node].mesh < model.nodes[b->node].mesh;
    });
    return instances;
}

uint64_t saturatingProduct(uint64_t a, uint64_t b) {
    return b != 0 && a > UINT64_MAX / b ? UINT64_MAX : a * b;
}

// Visits each primitive once however many nodes show it: files multiply cheaply.
PartSize sizeOfAll(const tinygltf::Model& model, const std::vector<const WorldNode*>& instances,
                   MemoryBudget& budget, Notes& notes) {
    std::map<int, uint64_t> nodesOfMesh;
    for (const WorldNode* world : instances) ++nodesOfMesh[model.nodes[world->node].mesh];
    PartSize total;
    uint64_t largest = 0;
    for (const auto& [meshIndex, count] : nodesOfMesh) {
        for (const auto& primitive : model.meshes[size_t(meshIndex)].primitives) {
            if (!hasTriangles(primitive, notes)) continue;
            const PartSize size = partSize(model, primitive);
            budget.charge(saturatingProduct(size.bytes() + sizeof(Surface), count), "its geometry");
            // The charge has shown that these are small.
            total.vertices += size.vertices * count;
            total.triangles += size.triangles * count;
            largest = std::max(largest, size.bytes());
        }
    }
    // A part is decoded, placed, and may be split for tangents before it is appended.
    budget.charge(saturatingProduct(largest, 3), "its geometry");
    // Split vertices can at most double them.
    if (2 * total.vertices >= UINT32_MAX || total.triangles >= UINT32_MAX)
        throw Problem("more than 2^32 triangles");
    return total;
}

void reserve(Scene& scene, const PartSize& size) {
    scene.positions.reserve(size.vertices);
    scene.normals.reserve(size.vertices);
    scene.tangents.reserve(size.vertices);
    scene.uv0.reserve(size.vertices);
    scene.uv1.reserve(size.vertices);
    scene.colors.reserve(size.vertices);
    scene.triangles.reserve(size.triangles);
    scene.triangleSurface.reserve(size.triangles);
}

uint32_t materialOf(const tinygltf::Primitive& primitive, size_t fileMaterials, Scene& scene) {
    if (primitive.material >= 0) return uint32_t(primitive.material);
    if (scene.materials.size() == fileMaterials) scene.materials.push_back(defaultMaterial());
    return uint32_t(fileMaterials);
}

}  // namespace

void flattenMeshes(const Document& document, const std::vector<WorldNode>& nodes, Scene& scene,
                   MemoryBudget& budget, Notes& notes) {
    const auto& model = document.model();
    const auto instances = instancesByMesh(model, nodes);
    reserve(scene, sizeOfAll(model, instances, budget, notes));

    Notes skippedAlready;  // counted by sizeOfAll
    for (size_t first = 0, last = 0; first < instances.size(); first = last) {
        const int meshIndex = model.nodes[instances[first]->node].mesh;
        while (last < instances.size() && model.nodes[instances[last]->node].mesh == meshIndex) ++last;
        const auto& mesh = model.meshes[size_t(meshIndex)];
        for (size_t p = 0; p < mesh.primitives.size(); ++p) {
            const auto& primitive = mesh.primitives[p];
            if (!hasTriangles(primitive, skippedAlready)) continue;
            const uint32_t material = materialOf(primitive, model.materials.size(), scene);
            const MeshPart local = readPart(document, primitive, scene.materials[material], notes);
            for (size_t i = first; i < last; ++i) {
                const Placement placement = placementOf(instances[i]->worldFromNode);
                MeshPart part = placed(local, placement, notes);
                if (part.triangles.empty()) continue;
                placeNormals(part, placement, notes);
                placeTangents(part, placement, notes);
                turnInvertedNormals(part, notes);
                Surface surface;
                surface.node = instances[i]->node;
                surface.mesh = uint32_t(meshIndex);
                surface.primitive = uint32_t(p);
                surface.material = material;
                surface.metersPerUnit = scaleAlongNormals(part, placement);
                surface.name = surfaceName(model.nodes[surface.node], mesh, surface.node);
                appendPart(scene, part, std::move(surface));
            }
        }
    }
}

}  // namespace phat::gltf
