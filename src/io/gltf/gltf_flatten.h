#pragma once
// Mesh instances to world-space surfaces.

#include "core/scene/scene.h"
#include "io/gltf/gltf_nodes.h"

namespace phat::gltf {

/// Appends every triangle primitive of every node: surfaces grouped by mesh, in node order within one. The
/// materials must be there already; primitives without one get a default at their end. Everything appended is
/// finite, normals and needed tangents are unit. Throws Problem.
void flattenMeshes(const Document& document, const std::vector<WorldNode>& nodes, Scene& scene,
                   MemoryBudget& budget, Notes& notes);

}  // namespace phat::gltf
