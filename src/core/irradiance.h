#pragma once
// View-independent light: irradiance per texel.

#include <vector>

#include "core/atlas.h"
#include "core/path.h"

namespace phat {

/// [y][x] of the atlas, W/m2 on the texel's plane. Invalid texels are filled from valid neighbours of their
/// chart, so that bilinear lookups inside a chart never meet a hole.
using IrradianceMap = std::vector<glm::vec3>;

/// Removes the noise of area-light estimates and keeps their shadow edges: each texel averages those of its
/// 7x7 neighbours in the chart that differ from it by no more than both estimates' standard errors explain.
/// Invalid texels are filled from valid ones.
IrradianceMap filterAreaIrradiance(const std::vector<IrradianceEstimate>& estimates, const Atlas& atlas,
                                   const TexelPoints& points);

}  // namespace phat
