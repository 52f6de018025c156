#pragma once
// Which sides of the surfaces receive texels.

#include <vector>

#include "core/bake/side_sight.h"
#include "core/scene/lit_scene.h"
#include "core/transport/photon_map.h"

namespace phat {

/// When a side is lit.
struct LitLimits {
    // Of the scene's usual irradiance: with so much, and of so many photons that they are no leak.
    double fraction;
    uint32_t photons;
    uint32_t seen;  // of kSideRays, that meet a lit side
};
inline constexpr LitLimits kLit{0.002, 4, 2}, kClearlyLit{0.02, 40, 20};

/// Per side: reached where light is.
std::vector<SideState> litStates(const LitScene& scene, const Components& components,
                                 const PhotonMap& photons, const LitLimits& limits);

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
