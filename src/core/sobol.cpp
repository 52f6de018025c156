#include "core/sobol.h"

#include <array>

#include "core/random.h"

namespace phat {
namespace {

constexpr int kBits = 32;
using Directions = std::array<uint32_t, kBits>;

// A primitive polynomial over GF(2) of degree s with inner coefficients a, and the first numbers m.
Directions directionNumbers(int s, uint32_t a, std::array<uint32_t, 3> m) {
    Directions v{};
    for (int i = 0; i < kBits; ++i) {
        if (s == 0) {
            v[i] = 1u << (31 - i);
        } else if (i < s) {
            v[i] = m[i] << (31 - i);
        } else {
            v[i] = v[i - s] ^ (v[i - s] >> s);
            for (int k = 1; k < s; ++k)
                if ((a >> (s - 1 - k)) & 1u) v[i] ^= v[i - k];
        }
    }
    return v;
}

const std::array<Directions, 4>& allDirections() {
    static const std::array<Directions, 4> directions = {
        directionNumbers(0, 0, {}), directionNumbers(1, 0, {1}), directionNumbers(2, 1, {1, 3}),
        directionNumbers(3, 1, {1, 3, 1})};
    return directions;
}

// Permutes the digits of x in base 2 from the highest, each by the ones above it: a hash whose every bit
// depends on lower ones only, applied to the reversed bits.
uint32_t owenScramble(uint32_t x, uint32_t seed) {
    x = reverseBits(x, 32);
    x ^= x * 0x3d20adeau;
    x += seed;
    x *= (seed >> 16) | 1u;
    x ^= x * 0x05526c56u;
    x ^= x * 0x53a22864u;
    return reverseBits(x, 32);
}

}  // namespace

glm::uvec4 sobolBits(uint32_t index) {
    glm::uvec4 point(0);
    for (int d = 0; d < 4; ++d)
        for (int bit = 0; bit < kBits && index >> bit; ++bit)
            if ((index >> bit) & 1u) point[d] ^= allDirections()[size_t(d)][size_t(bit)];
    return point;
}

glm::vec4 sobol4(uint32_t index, uint32_t seed) {
    const glm::uvec4 bits = sobolBits(index);
    glm::vec4 point;
    for (int d = 0; d < 4; ++d)
        point[d] = float(owenScramble(bits[d], uint32_t(hashOf(seed, uint64_t(d)))) >> 8) * 0x1p-24f;
    return point;
}

}  // namespace phat
