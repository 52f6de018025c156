#pragma once
// Low-discrepancy points.

#include <cstdint>

#include "core/base/math.h"

namespace phat {

/// Point `index` of Sobol's sequence in four dimensions (direction numbers of Joe and Kuo 2008),
/// Owen-scrambled by `seed`: every aligned run of 2^k points is stratified. In [0, 1). source: Burley 2020,
/// "Practical Hash-based Owen Scrambling".
glm::vec4 sobol4(uint32_t index, uint32_t seed);

/// The same point unscrambled, as fractions of 2^32. Linear: of i and j without common bits,
/// sobolBits(i + j) = sobolBits(i) ^ sobolBits(j), and any constant may be added by ^ without harm to
/// stratification.
glm::uvec4 sobolBits(uint32_t index);

inline constexpr uint32_t kMaxShuffled = 1u << 16;
inline constexpr uint64_t kSeedStep = 0x9e3779b97f4a7c15ull;

/// The same with the points in an order that `seed` shuffles, too: point `index` of several sets under
/// different seeds is one point of all their dimensions ("padding", Burley 2020, section 5). Runs that were
/// aligned stay so. Seeds must differ by hashing, or by multiples of 3 kSeedStep. pre: index < kMaxShuffled.
glm::vec4 shuffledSobol4(uint32_t index, uint64_t seed);

}  // namespace phat
