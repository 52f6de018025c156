#include "core/bvh/bvh_triangle.h"

namespace phat {
namespace {

constexpr int kCoordinateBits = 28;
/// Steps are no smaller, so that a sixteenth of one is no denormal float, which GPUs may take for 0.
constexpr int kMinStepExponent = -100;

float stepFor(float largest) {
    int exponent = 0;
    std::frexp(std::min(largest, kMaxCoordinate), &exponent);  // largest < 2^exponent
    return std::ldexp(1.0f, std::max(exponent - (kCoordinateBits - 1), kMinStepExponent));
}

// In the upper bits.
uint32_t shifted(float coordinate, float step) {
    const float clamped = std::clamp(coordinate, -kMaxCoordinate, kMaxCoordinate);
    return uint32_t(int32_t(std::nearbyint(clamped / step))) << (32 - kCoordinateBits);
}

}  // namespace

BvhGrid gridOver(std::span<const glm::vec3> positions) {
    glm::vec3 largest(0);
    for (const glm::vec3& p : positions) largest = glm::max(largest, glm::abs(p));
    return {{stepFor(largest.x), stepFor(largest.y), stepFor(largest.z)}};
}

BvhTriangle packTriangle(const BvhGrid& grid, const std::array<glm::vec3, 3>& corners) {
    BvhTriangle triangle;
    for (size_t i = 0; i < 8; ++i) {
        const int axis = int(i % 3);
        triangle.words[i] = shifted(corners[i / 3][axis], grid.stepMeters[axis]);
    }
    const uint32_t last = shifted(corners[2].z, grid.stepMeters.z) >> (32 - kCoordinateBits);
    for (size_t i = 0; i < 7; ++i) triangle.words[i] |= last >> (4 * i) & 15;
    return triangle;
}

std::array<glm::vec3, 3> cornersOf(const BvhGrid& grid, const BvhTriangle& triangle) {
    const glm::vec3 sixteenth = grid.stepMeters / 16.0f;
    const auto& w = triangle.words;
    const auto high = [](uint32_t word) { return float(int32_t(word & ~15u)); };
    uint32_t last = 0;
    for (size_t i = 0; i < 7; ++i) last |= (w[i] & 15) << (4 + 4 * i);
    return {glm::vec3(high(w[0]), high(w[1]), high(w[2])) * sixteenth,
            glm::vec3(high(w[3]), high(w[4]), high(w[5])) * sixteenth,
            glm::vec3(high(w[6]), high(w[7]), high(last)) * sixteenth};
}

}  // namespace phat
