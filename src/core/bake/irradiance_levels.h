#pragma once
// Texels at which irradiance is gathered, in three levels, and everything between them.

#include <functional>
#include <vector>

#include "core/bake/irradiance.h"
#include "core/base/resumable_task.h"

namespace phat {

inline constexpr uint32_t kNoNode = ~0u;
/// Texels between nodes. Groups of so many never mix charts: tiles are larger.
inline constexpr uint32_t kLevelSteps[] = {4, 2, 1};

/// One node a group of step x step texels, where `selects` holds for the group and it has one of
/// irradianceTexels: the one nearest its middle.
struct IrradianceLevel {
    uint32_t step = 1;
    glm::uvec2 size{0};                 // in groups
    std::vector<uint32_t> node;         // [y][x] of the groups; kNoNode
    std::vector<uint32_t> texel;        // per node
    std::vector<glm::vec3> value;       // per node, W/m2
    std::vector<float> distanceTexels;  // per node: harmonic mean distance of what it sees

    size_t groupOf(uint32_t texelIndex, uint32_t width) const {
        return size_t(texelIndex / width / step) * size.x + texelIndex % width / step;
    }
};

IrradianceLevel makeLevel(const Atlas& atlas, const std::vector<uint8_t>& irradianceTexels, uint32_t step,
                          const std::function<bool(glm::uvec2 group)>& selects);

/// Smooths the nodes and interpolates between them: local linear fits [Cleveland 1979] over neighbourhoods
/// that shrink with the distance of what the nodes see. `levels` from coarse to fine; a group of a finer
/// level has a node of every coarser one around it. Texels without a surface are filled from their chart's.
/// Other charts than `charts` are zero. `map` becomes the result.
ResumableTask interpolateLevels(const std::vector<IrradianceLevel>& levels, const Atlas& atlas,
                                const TexelPoints& points, const ChartSet& charts, IrradianceMap& map,
                                uint64_t sliceWork);

}  // namespace phat
