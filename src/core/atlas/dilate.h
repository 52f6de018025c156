#pragma once

#include <vector>

#include "core/atlas/atlas.h"

namespace phat {

/// Gives every texel of the charts' tiles that is not known the value of the nearest known texel of its
/// chart, so that smaller levels of a texture, whose texels are squares of up to a tile, mix no value of
/// nowhere into those of a chart. A chart without a known texel stays as it is. `values` and `known` are
/// [y][x] of the atlas.
void dilateWithinCharts(std::vector<glm::vec3>& values, const std::vector<uint8_t>& known,
                        const Atlas& atlas);

}  // namespace phat
