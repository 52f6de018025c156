#pragma once
// Irradiance everywhere, from levels of nodes.

#include <vector>

#include "core/bake/irradiance.h"
#include "core/bake/irradiance_level.h"
#include "core/base/resumable_task.h"

namespace phat {

/// Smooths the nodes and interpolates between them: local linear fits [Cleveland 1979] over neighbourhoods
/// that shrink with the distance of what the nodes see. `levels` from coarse to fine; a group of a finer
/// level has a node of every coarser one around it. Texels without a surface are filled from their chart's.
/// Other charts than `charts` are zero. `map` becomes the result.
ResumableTask interpolateLevels(const std::vector<IrradianceLevel>& levels, const Atlas& atlas,
                                const TexelPoints& points, const ChartSet& charts, IrradianceMap& map,
                                uint64_t sliceWork);

}  // namespace phat
