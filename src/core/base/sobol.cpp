#include "core/base/sobol.h"

#include <array>
#include <cassert>

#include "core/base/random.h"

namespace phat {
namespace {

constexpr int kBits = 32;
using DirectionNumbers = std::array<uint32_t, kBits>;

// A primitive polynomial over GF(2) of degree s with inner coefficients a, and the first numbers m.
DirectionNumbers directionNumbers(int s, uint32_t a, std::array<uint32_t, 3> m) {
    DirectionNumbers v{};
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

// Sums of direction numbers by the index's bytes, bit-reversed as the scrambling wants them:
// [dimension][byte][value].
using ByteTables = std::array<std::array<std::array<uint32_t, 256>, 4>, 4>;

ByteTables makeByteTables() {
    const std::array<DirectionNumbers, 4> directions = {
        directionNumbers(0, 0, {}), directionNumbers(1, 0, {1}), directionNumbers(2, 1, {1, 3}),
        directionNumbers(3, 1, {1, 3, 1})};
    ByteTables tables{};
    for (size_t d = 0; d < 4; ++d)
        for (size_t byte = 0; byte < 4; ++byte)
            for (uint32_t value = 0; value < 256; ++value) {
                uint32_t x = 0;
                for (size_t bit = 0; bit < 8; ++bit)
                    if ((value >> bit) & 1u) x ^= directions[d][8 * byte + bit];
                tables[d][byte][value] = reverseBits(x);
            }
    return tables;
}

const ByteTables kByteTables = makeByteTables();

uint32_t reversedSobol(size_t dimension, uint32_t index) {
    const auto& bytes = kByteTables[dimension];
    uint32_t x = bytes[0][index & 255u] ^ bytes[1][(index >> 8) & 255u];
    if (index >> 16) x ^= bytes[2][(index >> 16) & 255u] ^ bytes[3][index >> 24];
    return x;
}

// Permutes the digits of a number in base 2 from the highest, each by the ones above it, the lowest bit being
// the highest digit: a hash whose every bit depends on lower ones only.
uint32_t scrambleReversed(uint32_t x, uint32_t seed) {
    x ^= x * 0x3d20adeau;
    x += seed;
    x *= (seed >> 16) | 1u;
    x ^= x * 0x05526c56u;
    return x ^ (x * 0x53a22864u);
}

float toUnit(uint32_t x) {
    return float(x >> 8) * 0x1p-24f;
}

}  // namespace

glm::uvec4 sobolBits(uint32_t index) {
    glm::uvec4 point;
    for (int d = 0; d < 4; ++d) point[d] = reverseBits(reversedSobol(size_t(d), index));
    return point;
}

glm::vec4 sobol4(uint32_t index, uint32_t seed) {
    glm::vec4 point;
    for (int d = 0; d < 4; ++d)
        point[d] = toUnit(reverseBits(
            scrambleReversed(reversedSobol(size_t(d), index), uint32_t(hashOf(seed, uint64_t(d))))));
    return point;
}

glm::vec4 shuffledSobol4(uint32_t index, uint64_t seed) {
    assert(index < kMaxShuffled);
    const uint64_t order = mixBits(seed), first = mixBits(seed + kSeedStep),
                   second = mixBits(seed + 2 * kSeedStep);
    // The index's digits, the highest of 16 first, are scrambled like a coordinate's.
    const uint32_t shuffled = reverseBits(scrambleReversed(reverseBits(index << 16), uint32_t(order))) >> 16;
    const uint32_t seeds[4] = {uint32_t(first), uint32_t(first >> 32), uint32_t(second),
                               uint32_t(second >> 32)};
    glm::vec4 point;
    for (int d = 0; d < 4; ++d)
        point[d] = toUnit(reverseBits(scrambleReversed(reversedSobol(size_t(d), shuffled), seeds[d])));
    return point;
}

}  // namespace phat
