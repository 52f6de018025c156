#pragma once
// Directions of splatted photons. source: Hensley et al. 2003, section 5.1.1.

#include "core/phatexel/directions.h"

namespace phat {

/// A direction for every valid texel from the photons around it that `keep` takes, the k nearest within
/// `settings.density.maxRadius` on surfaces that face the same way:
/// - Directions::photons: one of them by weighted reservoir, the weight a cone that ends at the k-th;
/// - Directions::nearestPhoton: the nearest, the paper's naive strategy.
/// The direction is jittered within the photon's histogram cell, which gives it a density: the cell's
/// fraction of the weights. nearestPhoton has no density of its own and uses that of the k photons.
///
/// With `settings.splatsRadiance` the photon's light is the radiance (`splatRadiance`). The PHATexels of a
/// block then share one density, the mean of its texels', and 30 % of the directions are uniform, with the
/// radiance of the block's cell, mostly zero. source: ours. A texel's own 50 photons share 256 cells: their
/// light over the density of those few cells is right as a sum, but a ratio of sums takes it for the radiance
/// of all cells. pre: choosesPhotons(settings.strategy).
ChosenDirections choosePhotonDirections(const BlockGeometry& blocks, const PhotonSet& photons,
                                        PhotonFilter keep, const DirectionSettings& settings,
                                        Progress& progress);

}  // namespace phat
