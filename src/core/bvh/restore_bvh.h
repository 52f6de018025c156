#pragma once
// Trees that were built before and come from elsewhere.

#include <optional>
#include <vector>

#include "core/bvh/scene_bvh.h"

namespace phat {

/// The same as buildSceneBvh(rest) from the nodes and the order that it once had, in a fraction of the time.
/// Nothing where they are no trees of this scene: each node and each triangle must be there once, below its
/// group's root and inside of all boxes on the way, and within the stack. That also leaves no way to go in
/// circles.
std::optional<SceneBvh> restoreSceneBvh(const Scene& rest, std::vector<BvhNode> nodes,
                                        std::vector<uint32_t> order);

}  // namespace phat
