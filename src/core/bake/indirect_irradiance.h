#pragma once
// Indirect irradiance in two steps: the rays of its nodes, which can be updated one by one, and the light
// that bounces between them.

#include <array>

#include "core/bake/gather.h"
#include "core/bake/irradiance_levels.h"
#include "core/bake/irradiance_ray.h"
#include "core/base/resumable_task.h"

namespace phat {

// Rays of a node of the coarsest level, and of one of the finer levels.
inline constexpr uint32_t kNodeRays = 64, kFineRays = 32;

/// A node's rays: their direct light, and the texels in whose irradiance they end.
template <uint32_t kRays>
struct LinkedRays {
    glm::vec3 light{0};  // sum over the rays
    float nearness = 0;  // mean of 1 / metres
    uint32_t count = 0;  // rays above the surface
    std::array<uint32_t, kRays> texel;
    std::array<uint32_t, kRays> weight;  // RGB9E5
    /// Sum of the weights over that of the rounded ones: where all walls are white, weights are alike and are
    /// rounded alike, and a thousandth more of each reflection is a fiftieth more of all.
    glm::vec3 unrounded{1};
};
using NodeRays = LinkedRays<kNodeRays>;
/// Of a node of the finer levels, which lie closer.
using FineNodeRays = LinkedRays<kFineRays>;

/// The nodes of the coarsest level.
IrradianceLevel coarseLevel(const GatherInput& input);

/// Traces the rays of one node. `areaIrradiance`: as in gatherIndirectIrradiance.
NodeRays traceNode(const GatherInput& input, const std::vector<uint32_t>& areaIrradiance,
                   const BakeSettings& settings, const IrradianceLevel& level, size_t node, uint64_t& rays);

/// The map that follows from the rays of the coarsest level's `nodes`: light bounces between them, finer
/// nodes are added where something is near, and everything between is interpolated. `map` becomes it.
ResumableTask irradianceFromNodes(GatherContext context, const std::vector<uint32_t>& areaIrradiance,
                                  IrradianceLevel coarse, std::vector<NodeRays> nodes, IrradianceMap& map);

/// The map of some charts alone, in the light of `irradiance` as it is: one bounce further than that. Other
/// charts are zero. Nodes elsewhere need no rays.
ResumableTask irradianceOfCharts(GatherContext context, TexelIrradiance irradiance, IrradianceLevel coarse,
                                 const std::vector<NodeRays>& nodes, const ChartSet& charts,
                                 IrradianceMap& map);

}  // namespace phat
