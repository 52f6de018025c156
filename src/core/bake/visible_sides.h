#pragma once
// Which sides of the surfaces light may reach, after lamps are switched on and things have moved.

#include "core/bake/lit_sides.h"

namespace phat {

/// Per connected component: the sides that are lit, and those that light may reach by a few reflections from
/// where an eye or a light may be, also past what the scene's animations move. Eyes and lights may be in
/// rooms, at cameras, at point and spot lights, also where these are off, and around a scene that has no
/// inside, has a directional light or has a camera outside. The insides of closed solids are not visible.
/// The front where neither side is.
/// `clearlyVisible`, if given, becomes the sides that are so without doubt, as litSides has it.
std::vector<Sides> visibleSides(const LitScene& scene, const PhotonMap& photons,
                                std::vector<NeededSides>* clearlyVisible = nullptr);

}  // namespace phat
