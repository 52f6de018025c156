#pragma once
// View-independent statistics of the PHATexels around a tile.

#include <vector>

#include "core/atlas/atlas.h"
#include "core/phatexel/phatexture.h"
#include "core/scene/scene.h"

namespace phat {

/// Per tile, over its neighbourhood inside the chart: rgb = a radiance that no mean over the light arriving
/// there exceeds; a = the fraction of the hemisphere's solid angle that visible area lights fill.
std::vector<glm::vec4> tileLight(const Scene& scene, const Atlas& atlas, const Phatexture& phatexture);

}  // namespace phat
