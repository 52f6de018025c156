#pragma once
// The small tree over the groups of a scene, where they are now. It is built anew whenever something moves.

#include <span>

#include "core/bvh/scene_bvh.h"

namespace phat {

/// Nodes that follow those of the scene at rest: indices count from the first of SceneBvh::nodes. A group at
/// rest is there as a copy of its root, so that entering it costs nothing; one that was moved as an instance.
struct PosedBvh {
    std::vector<BvhNode> nodes;
    uint32_t root = 0;
};

/// The number of nodes that a PosedBvh can have at most.
uint32_t maxPosedNodes(const SceneBvh& bvh);

/// `worldFromRest` as SceneState has it. What a matrix makes flat is left out. Throws std::length_error where
/// the groups are too many for the stack.
PosedBvh poseBvh(const SceneBvh& bvh, std::span<const glm::mat4> worldFromRest);

}  // namespace phat
