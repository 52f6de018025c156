#include "io/gltf/gltf_nodes.h"

#include <fmt/core.h>

#include <glm/gtc/quaternion.hpp>
#include <nlohmann/json.hpp>

namespace phat::gltf {
namespace {

// Of a node's numbers; an empty vector is one that is not given.
glm::dmat4 parentFromNumbers(const std::vector<double>& matrix, const std::vector<double>& rotation,
                             const std::vector<double>& scale, const std::vector<double>& translation) {
    glm::dmat4 parentFromNode(1.0);
    if (!matrix.empty()) {
        for (int i = 0; i < 16; ++i) parentFromNode[i / 4][i % 4] = matrix[size_t(i)];
        return parentFromNode;
    }
    if (!rotation.empty()) {
        glm::dquat q(rotation[3], rotation[0], rotation[1], rotation[2]);
        const double length = glm::length(q);
        // Exporters round; a quaternion of no length says nothing.
        q = length > 1e-12 ? q / length : glm::dquat(1, 0, 0, 0);
        parentFromNode = glm::mat4_cast(q);
    }
    if (!scale.empty())
        for (int axis = 0; axis < 3; ++axis) parentFromNode[axis] *= scale[size_t(axis)];
    if (!translation.empty())
        parentFromNode[3] = glm::dvec4(translation[0], translation[1], translation[2], 1.0);
    return parentFromNode;
}

bool hides(const tinygltf::Node& node) {
    const auto found = node.extensions.find("KHR_node_visibility");
    if (found == node.extensions.end() || !found->second.Has("visible")) return false;
    const tinygltf::Value& visible = found->second.Get("visible");
    return visible.IsBool() && !visible.Get<bool>();
}

std::vector<int> rootsOf(const tinygltf::Model& model, const std::vector<int>& parentOf, Notes& notes) {
    if (!model.scenes.empty()) {
        if (model.scenes.size() > 1) {
            notes.lines.push_back(
                fmt::format("only the default one of {} scenes is shown", model.scenes.size()));
        }
        return model.scenes[size_t(std::max(model.defaultScene, 0))].nodes;
    }
    if (!model.nodes.empty()) notes.lines.push_back("the file has no scene: all its nodes are shown");
    std::vector<int> roots;
    for (size_t i = 0; i < model.nodes.size(); ++i)
        if (parentOf[i] < 0) roots.push_back(int(i));
    return roots;
}

}  // namespace

std::vector<WorldNode> worldNodes(const tinygltf::Model& model, Notes& notes) {
    std::vector<int> parentOf(model.nodes.size(), -1);
    for (size_t i = 0; i < model.nodes.size(); ++i) {
        for (const int child : model.nodes[i].children) {
            if (parentOf[size_t(child)] >= 0) throw Problem(fmt::format("node {} has two parents", child));
            parentOf[size_t(child)] = int(i);
        }
    }

    std::vector<WorldNode> flat;
    std::vector<bool> visited(model.nodes.size(), false);
    const auto visit = [&](int index, const glm::dmat4& worldFromParent, bool hidden) {
        if (visited[size_t(index)]) throw Problem(fmt::format("node {} is reached twice (a cycle)", index));
        visited[size_t(index)] = true;
        const tinygltf::Node& node = model.nodes[size_t(index)];
        const glm::dmat4 parentFromNode =
            parentFromNumbers(node.matrix, node.rotation, node.scale, node.translation);
        flat.push_back({uint32_t(index), worldFromParent * parentFromNode, hidden || hides(node)});
    };
    for (const int root : rootsOf(model, parentOf, notes)) visit(root, glm::dmat4(1.0), false);
    // Breadth first; the list is its own queue, so that deep chains need no stack.
    for (size_t next = 0; next < flat.size(); ++next) {
        const WorldNode parent = flat[next];
        for (const int child : model.nodes[parent.node].children)
            visit(child, parent.worldFromNode, parent.hidden);
    }
    return flat;
}

glm::dmat4 parentFromNode(const nlohmann::json& node) {
    const auto numbers = [&](const char* key, size_t count) {
        if (!node.contains(key)) return std::vector<double>();
        const auto values = node.at(key).get<std::vector<double>>();
        if (values.size() != count) throw Problem(fmt::format("a node's {} has not {} numbers", key, count));
        return values;
    };
    return parentFromNumbers(numbers("matrix", 16), numbers("rotation", 4), numbers("scale", 3),
                             numbers("translation", 3));
}

}  // namespace phat::gltf
