#include "io/gltf/gltf_nodes.h"

#include <fmt/core.h>

#include <glm/gtc/quaternion.hpp>

namespace phat::gltf {
namespace {

glm::dmat4 parentFromNode(const tinygltf::Node& node) {
    glm::dmat4 matrix(1.0);
    if (!node.matrix.empty()) {
        for (int i = 0; i < 16; ++i) matrix[i / 4][i % 4] = node.matrix[size_t(i)];
        return matrix;
    }
    if (!node.rotation.empty()) {
        glm::dquat q(node.rotation[3], node.rotation[0], node.rotation[1], node.rotation[2]);
        const double length = glm::length(q);
        // Exporters round; a quaternion of no length says nothing.
        q = length > 1e-12 ? q / length : glm::dquat(1, 0, 0, 0);
        matrix = glm::mat4_cast(q);
    }
    if (!node.scale.empty())
        for (int axis = 0; axis < 3; ++axis) matrix[axis] *= node.scale[size_t(axis)];
    if (!node.translation.empty())
        matrix[3] = glm::dvec4(node.translation[0], node.translation[1], node.translation[2], 1.0);
    return matrix;
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
    const auto visit = [&](int node, const glm::dmat4& worldFromParent) {
        if (visited[size_t(node)]) throw Problem(fmt::format("node {} is reached twice (a cycle)", node));
        visited[size_t(node)] = true;
        flat.push_back({uint32_t(node), worldFromParent * parentFromNode(model.nodes[size_t(node)])});
    };
    for (const int root : rootsOf(model, parentOf, notes)) visit(root, glm::dmat4(1.0));
    // Breadth first; the list is its own queue, so that deep chains need no stack.
    for (size_t next = 0; next < flat.size(); ++next) {
        const WorldNode parent = flat[next];
        for (const int child : model.nodes[parent.node].children) visit(child, parent.worldFromNode);
    }
    return flat;
}

}  // namespace phat::gltf
