#pragma once
// From estimates of irradiance to the maps that are stored and read.

#include <vector>

#include "core/bake/gather.h"
#include "core/bake/seam_stitch.h"

namespace phat {

/// Stitched and packed: Phatexture::areaIrradiance. `irradiance`: of filterAreaIrradiance.
std::vector<uint32_t> finishAreaIrradiance(IrradianceMap irradiance, const GatherInput& input,
                                           const std::vector<SeamPoint>& seams, const Progress& progress);

/// Stitched and packed: Phatexture::indirectIrradiance.
std::vector<uint32_t> finishIndirectIrradiance(IrradianceMap irradiance, const GatherInput& input,
                                               const std::vector<SeamPoint>& seams, const Progress& progress);

}  // namespace phat
