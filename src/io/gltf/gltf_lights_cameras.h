#pragma once
// Lights and cameras of the nodes.

#include "core/scene/scene.h"
#include "io/gltf/gltf_nodes.h"

namespace phat::gltf {

/// Farther coordinates lose to infinity where lengths are raised to the fourth power in a float (areas of
/// triangles, squared): (2^128)^(1/4) = 4e9.
inline constexpr double kMaxCoordinateMeters = 1e9;

/// Cameras, KHR_lights_punctual and EXT_lights_ies of the nodes, in node order. Their scale means nothing; a
/// camera's frame is made orthonormal. What is too far away is noted and left out. Names are the nodes', or
/// else their own.
void readLightsAndCameras(const Document& document, const std::vector<WorldNode>& nodes, Scene& scene,
                          MemoryBudget& budget, Notes& notes);

}  // namespace phat::gltf
