#pragma once

#include "core/atlas/atlas.h"
#include "core/atlas/unwrap.h"

namespace phat {

/// Texels with a surface under their centre over all texels.
float coverageOf(const Atlas& atlas);

/// `flats`: the pieces that the atlas was made of.
AtlasStats statsOf(const Atlas& atlas, const std::vector<FlatChart>& flats, const MeshTopology& topology);

}  // namespace phat
