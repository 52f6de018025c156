#pragma once
// Which sides of the surfaces receive texels.

#include <vector>

#include "core/atlas/earlier_charts.h"
#include "core/transport/path.h"
#include "core/transport/photon_map.h"

namespace phat {

/// Per connected component: the sides that light reaches, as far as its material shows them. A side counts as
/// lit when photons bring it as much light an area as is usual in the scene, or when it sees such a side; so
/// the outside of a lamp shade has texels, however bright its inside is, and the inside of a solid, into
/// which a few photons leak through its seams, has none. The front where neither side is lit.
/// `clearlyLit`, if given, becomes the sides that are lit far beyond noise, for a bake that continues an
/// earlier one: none of a piece that nearly no light reaches. Sides near the limits would be lit in one bake
/// and dark in the next.
std::vector<Sides> litSides(const LitScene& scene, const PhotonMap& photons,
                            std::vector<NeededSides>* clearlyLit = nullptr);

}  // namespace phat
