#pragma once
// The length by which a scene is measured, so that its picture does not depend on the unit that it is in.

#include "core/scene/scene.h"

namespace phat {

/// Metres: an eighth of the diagonal of the scene's bounds without a ground (boundsWithoutGround), and so
/// about a metre in a room of usual size. 1 where there is nothing to measure. Lengths that the algorithms
/// choose for themselves are multiples of it. It is not rounded: a scene that is scaled by a power of two has
/// exactly scaled lengths. ours.
float lengthUnit(const Scene& scene);

}  // namespace phat
