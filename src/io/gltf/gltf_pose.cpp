#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <map>
#include <optional>

#include "io/gltf/gltf_json.h"
#include "io/gltf/gltf_nodes.h"
#include "io/gltf/gltf_plain.h"
#include "io/gltf/gltf_skin.h"

namespace phat::gltf {
namespace {

using nlohmann::json;

bool isSkinAttribute(const std::string& name) {
    return name.starts_with("JOINTS_") || name.starts_with("WEIGHTS_");
}

// World transforms of the nodes, by way of their parents, each computed once. Parents in a circle are an
// error that worldNodes reports; here they only must not make a loop.
class Hierarchy {
  public:
    explicit Hierarchy(const json& gltf) : gltf_(gltf), parent_(parentNodes(gltf)), world_(parent_.size()) {}

    glm::dmat4 worldFromNode(uint64_t node) {
        gltfItem(gltf_, "nodes", node);
        std::vector<size_t> path;  // upwards, to a node that is known
        for (int64_t up = int64_t(node); up >= 0 && !world_[size_t(up)]; up = parent_[size_t(up)]) {
            if (path.size() == parent_.size()) throw Problem(fmt::format("node {} is its own parent", node));
            path.push_back(size_t(up));
        }
        for (; !path.empty(); path.pop_back()) {
            const size_t at = path.back();
            const glm::dmat4 own = parentFromNode(gltf_["nodes"][at]);
            world_[at] = parent_[at] < 0 ? own : *world_[size_t(parent_[at])] * own;
        }
        return *world_[node];
    }

  private:
    const json& gltf_;
    std::vector<int64_t> parent_;
    std::vector<std::optional<glm::dmat4>> world_;
};

// Specification, section 3.7.3.3: joint transform times inverse bind matrix, in the space of the scene.
std::vector<glm::dmat4> jointMatrices(const GltfSource& source, Hierarchy& hierarchy, uint64_t skinIndex,
                                      MemoryBudget& budget) {
    const json& skin = gltfItem(source.json, "skins", skinIndex);
    const json& joints = skin.at("joints");
    budget.charge(joints.size() * sizeof(glm::dmat4), "its skins");
    std::vector<float> inverseBind;
    if (skin.contains("inverseBindMatrices"))
        inverseBind = accessorFloats(source, wholeNumber(skin, "inverseBindMatrices"), 16);
    if (!inverseBind.empty() && inverseBind.size() / 16 < joints.size())
        throw Problem(fmt::format("skin {} has fewer matrices than joints", skinIndex));
    std::vector<glm::dmat4> matrices;
    for (size_t j = 0; j < joints.size(); ++j) {
        glm::dmat4 bind(1.0);
        for (size_t i = 0; i < 16 && !inverseBind.empty(); ++i)
            bind[int(i / 4)][int(i % 4)] = double(inverseBind[16 * j + i]);
        matrices.push_back(hierarchy.worldFromNode(joints[j].get<uint64_t>()) * bind);
    }
    return matrices;
}

constexpr const char* kDeformed[] = {"POSITION", "NORMAL", "TANGENT"};

uint32_t vectorSize(const std::string& name) {
    return name == "TANGENT" ? 4 : 3;
}

Geometry readGeometry(const GltfSource& source, const json& attributes, uint64_t count) {
    Geometry geometry;
    for (const char* name : kDeformed)
        if (attributes.contains(name))
            *geometry.of(name) = accessorFloats(source, wholeNumber(attributes, name), vectorSize(name),
                                                std::string_view(name) != "POSITION", count);
    return geometry;
}

// Specification, section 3.7.2.2: base plus the weighted sum of the targets' displacements.
void addTargets(const GltfSource& source, const json& primitive, const std::vector<double>& weights,
                uint64_t count, Geometry& geometry) {
    if (!primitive.contains("targets")) return;
    const json& targets = primitive["targets"];
    for (size_t t = 0; t < std::min(targets.size(), weights.size()); ++t) {
        if (weights[t] == 0) continue;
        for (const char* name : kDeformed) {
            std::vector<float>& base = *geometry.of(name);
            if (base.empty() || !targets[t].contains(name)) continue;
            const std::vector<float> displacement =
                accessorFloats(source, wholeNumber(targets[t], name), 3, false, count);
            const size_t stride = vectorSize(name);  // a tangent's handedness stays
            for (size_t v = 0; v < count; ++v)
                for (size_t c = 0; c < 3; ++c)
                    base[v * stride + c] += float(weights[t] * double(displacement[v * 3 + c]));
        }
    }
}

// The shape of one node's mesh, and what it takes to pose it.
struct Pose {
    std::vector<double> weights;                      // of morph targets
    const std::vector<glm::dmat4>* joints = nullptr;  // null: not skinned
};

void posePrimitive(GltfSource& source, json& primitive, const Pose& pose, MemoryBudget& budget) {
    json& attributes = primitive.at("attributes");
    if (attributes.contains("POSITION")) {
        const uint64_t accessor = wholeNumber(attributes, "POSITION");
        const uint64_t count = wholeNumber(gltfItem(source.json, "accessors", accessor), "count");
        // Three arrays, a displacement, joints, weights and a matrix.
        constexpr uint64_t kVertexBytes = 2 * 40 + 16 + 2 * 16 + sizeof(glm::dmat4) + 8;
        if (count > budget.left() / kVertexBytes) budget.charge(~0ull, "its posed meshes");
        budget.charge(count * kVertexBytes, "its posed meshes");
        Geometry geometry = readGeometry(source, attributes, count);
        addTargets(source, primitive, pose.weights, count, geometry);
        if (pose.joints && attributes.contains("JOINTS_0")) {
            const std::vector<glm::dmat4> matrices = blendedMatrices(source, attributes, count, *pose.joints);
            skinGeometry(matrices, geometry);
            turnMirrored(source, primitive, matrices, budget);
        }
        for (const char* name : kDeformed)
            if (attributes.contains(name))
                attributes[name] = addFloats(source, *geometry.of(name), vectorSize(name));
        budget.release(count * (kVertexBytes - 40));
    }
    primitive.erase("targets");
    for (auto it = attributes.begin(); it != attributes.end();)
        it = isSkinAttribute(it.key()) ? attributes.erase(it) : std::next(it);
}

std::vector<double> weightsOf(const json& node, const json& mesh) {
    for (const json* owner : {&node, &mesh})
        if (owner->contains("weights")) return owner->at("weights").get<std::vector<double>>();
    return {};
}

// What a mesh has that moves its vertices; looked up once however many nodes show it.
struct Deforms {
    bool bySkin = false, byTargets = false;
};

Deforms deformsOf(const json& mesh) {
    Deforms deforms;
    for (size_t p = 0; p < countOf(mesh, "primitives"); ++p) {
        const json& primitive = mesh["primitives"][p];
        deforms.bySkin = deforms.bySkin || primitive.at("attributes").contains("JOINTS_0");
        deforms.byTargets = deforms.byTargets || countOf(primitive, "targets") > 0;
    }
    return deforms;
}

// What animated the weights of the old node follows the mesh, so that the rewriter knows whose they were.
void retargetWeights(json& gltf, uint64_t from, uint64_t to) {
    for (size_t a = 0; a < countOf(gltf, "animations"); ++a) {
        json& animation = gltf["animations"][a];
        for (size_t c = 0; c < countOf(animation, "channels"); ++c) {
            json& channel = animation["channels"][c];
            if (!channel.is_object() || !channel.contains("target")) continue;
            json& target = channel["target"];
            if (target.is_object() && target.contains("node") && target["node"] == from &&
                target.value("path", "") == "weights")
                target["node"] = to;
        }
    }
}

void moveToRoot(json& gltf, uint64_t node) {
    json& nodes = gltf["nodes"];
    const uint64_t root = nodes.size();
    json moved = {{"mesh", nodes[node]["mesh"]}};
    if (nodes[node].contains("name")) moved["name"] = nodes[node]["name"];
    nodes[node].erase("mesh");
    nodes.push_back(std::move(moved));
    retargetWeights(gltf, node, root);
    if (countOf(gltf, "scenes") > 0) gltf["scenes"][wholeNumber(gltf, "scene", 0)]["nodes"].push_back(root);
}

class Poser {
  public:
    Poser(GltfSource& source, MemoryBudget& budget, Notes& notes)
        : source_(source), budget_(budget), notes_(notes), hierarchy_(source.json) {
        for (size_t n = 0; n < countOf(source.json, "nodes"); ++n)
            if (source.json["nodes"][n].contains("mesh"))
                ++meshUsers_[wholeNumber(source.json["nodes"][n], "mesh")];
    }

    void pose(uint64_t nodeIndex) {
        const json& node = gltfItem(source_.json, "nodes", nodeIndex);
        if (!node.contains("mesh")) return;
        const uint64_t meshIndex = wholeNumber(node, "mesh");
        const Deforms deforms = deformsOfMesh(meshIndex);
        const bool skinned = node.contains("skin") && deforms.bySkin;
        if (!skinned && !deforms.byTargets) return;
        json mesh = gltfItem(source_.json, "meshes", meshIndex);
        Pose pose{weightsOf(node, mesh), nullptr};
        notes_.skinnedMeshes += skinned;
        notes_.morphedMeshes += deforms.byTargets;
        const bool morphs = deforms.byTargets && std::any_of(pose.weights.begin(), pose.weights.end(),
                                                             [](double weight) { return weight != 0; });
        if (!skinned && !morphs) return;
        if (skinned) pose.joints = &jointsOf(wholeNumber(node, "skin"));
        for (json& primitive : mesh["primitives"]) posePrimitive(source_, primitive, pose, budget_);
        mesh.erase("weights");

        uint64_t target = meshIndex;
        if (meshUsers_[meshIndex]-- > 1) {
            target = source_.json["meshes"].size();
            source_.json["meshes"].push_back(json());
        }
        source_.json["meshes"][target] = std::move(mesh);
        json& posed = source_.json["nodes"][nodeIndex];
        posed["mesh"] = target;
        for (const char* key : {"skin", "weights"}) posed.erase(key);
        if (skinned) moving_.push_back(nodeIndex);
    }

    // After all are posed: the joints' transforms are those of the file until then.
    void moveSkinned() {
        for (const uint64_t node : moving_) moveToRoot(source_.json, node);
    }

  private:
    Deforms deformsOfMesh(uint64_t mesh) {
        const auto found = deforms_.find(mesh);
        if (found != deforms_.end()) return found->second;
        return deforms_[mesh] = deformsOf(gltfItem(source_.json, "meshes", mesh));
    }

    const std::vector<glm::dmat4>& jointsOf(uint64_t skin) {
        const auto found = joints_.find(skin);
        if (found != joints_.end()) return found->second;
        return joints_[skin] = jointMatrices(source_, hierarchy_, skin, budget_);
    }

    GltfSource& source_;
    MemoryBudget& budget_;
    Notes& notes_;
    Hierarchy hierarchy_;
    std::map<uint64_t, std::vector<glm::dmat4>> joints_;  // by skin
    std::map<uint64_t, Deforms> deforms_;                 // by mesh
    std::map<uint64_t, size_t> meshUsers_;
    std::vector<uint64_t> moving_;
};

}  // namespace

void applyPose(GltfSource& source, MemoryBudget& budget, Notes& notes) {
    Poser poser(source, budget, notes);
    for (const uint64_t node : sceneNodes(source.json, false)) poser.pose(node);
    poser.moveSkinned();
}

}  // namespace phat::gltf
