#include "gl/sample_numbers.h"

#include <array>
#include <bit>

#include "core/base/random.h"
#include "core/base/sobol.h"

namespace phat {

void setSampleNumbers(const ShaderProgram& program, uint32_t count, uint32_t seed) {
    constexpr uint32_t kRanks = 16, kPlaces = 13;
    // Bayer's order: neighbouring pixels take samples that are far apart.
    constexpr uint32_t kBayer[kRanks] = {0, 8, 2, 10, 12, 4, 14, 6, 3, 11, 1, 9, 15, 7, 13, 5};
    std::array<glm::uvec4, kMaxSamples> numbers;
    std::array<glm::uvec4, kRanks> ranks;
    const uint32_t run = std::bit_ceil(count);
    for (uint32_t rank = 0; rank < kRanks; ++rank) ranks[rank] = sobolBits(run * kBayer[rank]);
    glm::uvec4 shift;
    for (int d = 0; d < 4; ++d) shift[d] = uint32_t(hashOf(seed, uint64_t(d)));
    for (uint32_t k = 0; k < kMaxSamples; ++k) numbers[k] = sobolBits(k) ^ shift;
    std::array<glm::uvec4, kPlaces> places;
    for (uint32_t i = 0; i < kPlaces; ++i) places[i] = sobolBits(1u << i);
    program.set("placeNumbers", std::span<const glm::uvec4>(places));
    program.set("sampleNumbers", std::span<const glm::uvec4>(numbers));
    program.set("ranks", std::span<const glm::uvec4>(ranks));
}

}  // namespace phat
