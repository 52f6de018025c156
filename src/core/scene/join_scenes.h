#pragma once
// Two scenes in one.

#include "core/scene/scene.h"

namespace phat {

/// Appends the surfaces of `from` with their materials and pictures. Its lights, cameras, environment, nodes
/// and animations are left out; its surfaces keep the nodes that they had.
void appendSurfaces(Scene& scene, const Scene& from);

}  // namespace phat
