#pragma once

#include <vector>

#include "core/atlas/atlas.h"

namespace phat {

/// Extrapolates known values to unknown texels, nearest ring first, four rings far. Neighbours are of the
/// same chart and lie in the world as they do in it (texel_neighbors.h). The first ring continues the slope
/// of what it touches, the others copy. Values are >= 0. `values` and `known` are [y][x] of the atlas.
void fillWithinCharts(std::vector<glm::vec3>& values, std::vector<uint8_t>& known, const Atlas& atlas,
                      const TexelPoints& points);

}  // namespace phat
