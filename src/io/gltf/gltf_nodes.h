#pragma once
// The node hierarchy, flattened.

#include <glm/glm.hpp>
#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "io/gltf/gltf_document.h"

namespace phat::gltf {

struct WorldNode {
    uint32_t node = 0;              // index into the file
    glm::dmat4 worldFromNode{1.0};  // in double: long chains and far origins cost digits
    bool hidden = false;            // by KHR_node_visibility: neither mesh nor light is shown
};

/// The nodes of the file's scene, parents before children. Without any scene: all nodes. Throws Problem when
/// the nodes form no forest (specification, section 3.5.2): cycles, or two parents.
std::vector<WorldNode> worldNodes(const tinygltf::Model& model, Notes& notes);

/// Of a node of the file's JSON. Throws where its numbers have the wrong type or count.
glm::dmat4 parentFromNode(const nlohmann::json& node);

}  // namespace phat::gltf
