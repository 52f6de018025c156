#pragma once

#include "core/atlas/atlas.h"

namespace phat {

/// About the side of the texels on rough surfaces that an atlas will have, metres: that of the settings, or
/// what the budget allows for the scene's area, where far triangles count as far pieces do (far_density.h).
/// 0: nothing has an area.
double expectedTexelSizeMeters(const Scene& scene, const AtlasSettings& settings);

}  // namespace phat
