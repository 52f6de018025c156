#pragma once
// The hierarchy of nodes and its animations, for scenes that move.

#include "core/scene/scene.h"
#include "io/gltf/gltf_nodes.h"

namespace phat::gltf {

/// Fills Scene::nodes and Scene::animations. Channels that move no node (weights of morph targets), and those
/// that the specification does not allow, are left out with a note. `shown`: worldNodes of the file; the
/// others have no parents here, because nobody has looked whether they are their own.
void readAnimations(const Document& document, const std::vector<WorldNode>& shown, Scene& scene,
                    MemoryBudget& budget, Notes& notes);

}  // namespace phat::gltf
