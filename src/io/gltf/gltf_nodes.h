#pragma once
// The node hierarchy, flattened.

#include <glm/glm.hpp>
#include <vector>

#include "io/gltf/gltf_document.h"

namespace phat::gltf {

struct WorldNode {
    uint32_t node = 0;              // index into the file
    glm::dmat4 worldFromNode{1.0};  // in double: long chains and far origins cost digits
};

/// The nodes of the file's scene, parents before children. Without any scene: all nodes. Throws Problem when
/// the nodes form no forest (specification, section 3.5.2): cycles, or two parents.
std::vector<WorldNode> worldNodes(const tinygltf::Model& model, Notes& notes);

}  // namespace phat::gltf
