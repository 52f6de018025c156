#pragma once
// Texels at which irradiance is gathered: a level of nodes, one for each piece of surface in a group of
// texels.

#include <functional>
#include <vector>

#include "core/bake/irradiance.h"

namespace phat {

inline constexpr uint32_t kNoNode = ~0u;
/// Texels between nodes. Groups of so many never mix charts: tiles are larger.
inline constexpr uint32_t kLevelSteps[] = {4, 2, 1};

/// A node for each piece of surface that has irradianceTexels in a group of step x step texels, where
/// `selects` holds for the group: the one of these texels nearest their middle. Small pieces lie side by side
/// in a chart, wherever they are in the world, and light goes from none to another.
struct IrradianceLevel {
    uint32_t step = 1;
    glm::uvec2 size{0};                 // in groups
    std::vector<uint32_t> node;         // [y][x] of the groups: the first node; kNoNode
    std::vector<uint32_t> next;         // per node: another one of its group; kNoNode
    std::vector<uint32_t> texel;        // per node
    std::vector<glm::vec3> value;       // per node, W/m2
    std::vector<float> distanceTexels;  // per node: harmonic mean distance of what it sees

    size_t groupOf(uint32_t texelIndex, uint32_t width) const {
        return size_t(texelIndex / width / step) * size.x + texelIndex % width / step;
    }
    /// The node of a texel's group that is of its piece of surface. kNoNode if there is none, always where
    /// the texel has no triangle.
    uint32_t nodeOf(const Atlas& atlas, const TexelPoints& points, uint32_t texelIndex) const;
};

IrradianceLevel makeLevel(const ReceiverTexels& texels, uint32_t step,
                          const std::function<bool(glm::uvec2 group)>& selects);

}  // namespace phat
