#pragma once

#include <vector>

#include "core/atlas/atlas.h"

namespace phat {

/// Extrapolates known values to unknown texels of the same chart, nearest ring first, until no texel with a
/// known neighbour is left. The first ring continues the slope of what it touches, the others copy. Values
/// are >= 0. `values` and `known` are [y][x] of the atlas taken at every `step`-th texel.
void fillWithinCharts(std::vector<glm::vec3>& values, std::vector<uint8_t>& known, const Atlas& atlas,
                      uint32_t step = 1);

}  // namespace phat
