#pragma once
// The paper's 16 bytes a PHATexel in a file, and the 8 that everything else holds.

#include <span>
#include <vector>

#include "core/phatexel/phatexture.h"

namespace phat {

std::vector<PackedPhatexel16> paperOfPacked(std::span<const PackedPhatexel> texels);

/// Radiance is rounded to RGB9E5 (a bake's own is not changed by that) and the direction to 24 bits, within
/// its cell of the guides; the distance is infinite. Throws std::runtime_error where a value is none: a
/// radiance that is negative or not finite, a direction that does not lie in the upper hemisphere.
std::vector<PackedPhatexel> packedOfPaper(std::span<const PackedPhatexel16> texels);

}  // namespace phat
