#pragma once
// Counter-based randomness: every consumer derives its own stream from (seed, purpose, index), so results do
// not depend on the number of threads or on the order of work.

#include <cassert>
#include <cstdint>

#include "core/base/math.h"

namespace phat {

/// 64-bit finaliser; a bijection with full avalanche. source: Stafford 2011, variant 13 ("splitmix64").
inline uint64_t mixBits(uint64_t x) {
    x ^= x >> 30;
    x *= 0xbf58476d1ce4e5b9ull;
    x ^= x >> 27;
    x *= 0x94d049bb133111ebull;
    return x ^ (x >> 31);
}

/// Hash of up to three numbers.
inline uint64_t hashOf(uint64_t a, uint64_t b = 0, uint64_t c = 0) {
    return mixBits(mixBits(mixBits(a + 0x9e3779b97f4a7c15ull) + b) + c);
}

/// A small random stream (splitmix64). Copyable; no global state.
class Rng {
  public:
    explicit Rng(uint64_t seed) : state_(mixBits(seed + 0x9e3779b97f4a7c15ull)) {}

    uint32_t bits() {
        state_ += 0x9e3779b97f4a7c15ull;
        return uint32_t(mixBits(state_) >> 32);
    }
    uint64_t bits64() {
        const uint64_t high = bits();
        return (high << 32) | bits();
    }
    /// Uniform in [0, 1): 24 bits, never 1.
    float uniform() { return float(bits() >> 8) * 0x1p-24f; }
    glm::vec2 uniform2() {
        const float x = uniform();
        return {x, uniform()};
    }

  private:
    uint64_t state_;
};

/// Interleaves the low 16 bits of x (even positions) and y (odd positions).
uint32_t morton(uint32_t x, uint32_t y);
/// Inverse of morton.
glm::uvec2 mortonDecode(uint32_t code);
/// Reverses all bits.
inline uint32_t reverseBits(uint32_t x) {
    x = ((x >> 1) & 0x55555555u) | ((x & 0x55555555u) << 1);
    x = ((x >> 2) & 0x33333333u) | ((x & 0x33333333u) << 2);
    x = ((x >> 4) & 0x0f0f0f0fu) | ((x & 0x0f0f0f0fu) << 4);
    x = ((x >> 8) & 0x00ff00ffu) | ((x & 0x00ff00ffu) << 8);
    return (x >> 16) | (x << 16);
}
/// Reverses the lowest `bitCount` bits of x; higher bits must be 0. pre: bitCount in [1, 32].
inline uint32_t reverseBits(uint32_t x, int bitCount) {
    assert(bitCount >= 1 && bitCount <= 32 && (bitCount == 32 || x >> bitCount == 0));
    return reverseBits(x) >> (32 - bitCount);
}

}  // namespace phat
