#pragma once
// Where irradiance needs finer nodes.

#include "core/bake/irradiance_level.h"

namespace phat {

/// The level of `step` after `coarse`: nodes in those of the coarse groups of some charts near which there
/// are other surfaces, or in which irradiance (`map`, [y][x], smooth) changes by much from one to the next.
/// Without values and distances.
IrradianceLevel finerLevel(const ReceiverTexels& texels, const IrradianceLevel& coarse, uint32_t step,
                           const IrradianceMap& map, const ChartSet& charts);

}  // namespace phat
