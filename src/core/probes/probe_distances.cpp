#include "core/probes/probe_distances.h"

namespace phat {
namespace {

constexpr float kRangeSteps = 16, kRangeLowest = -4;

// A point on a surface is seen, in spite of rounding; one that is farther behind it than this is not.
constexpr float kSeenWithin = 1.02f, kHiddenFrom = 1.06f;
// Weights of what is hidden: at once, and how often it is halved over one more distance to the surface.
constexpr float kHiddenWeight = 1e-4f, kHiddenHalvings = 60, kMinWeight = 1e-30f;

float rangeOf(uint8_t code, float unitMeters) {
    return std::exp2(float(code) / kRangeSteps + kRangeLowest) / unitMeters;
}

}  // namespace

glm::vec3 distanceNode(int index) {
    const glm::ivec2 node = glm::ivec2(index % kDistanceNodes, index / kDistanceNodes) - kDistanceIntervals;
    const glm::vec2 square = glm::vec2(node) / float(kDistanceIntervals);
    const glm::vec2 size = glm::abs(square);
    const float z = 1.0f - size.x - size.y;
    if (z >= 0.0f) return {square, z};
    const auto sign = [](float x) { return x < 0.0f ? -1.0f : 1.0f; };
    return {(1.0f - size.y) * sign(square.x), (1.0f - size.x) * sign(square.y), z};
}

ProbeDistances packDistances(const std::array<float, kDistanceNodes * kDistanceNodes>& reciprocal,
                             float unitMeters) {
    float largest = 0;
    for (const float value : reciprocal) largest = std::max(largest, value);
    ProbeDistances packed;
    if (largest <= 0.0f) return packed;
    const float code = std::ceil(kRangeSteps * (std::log2(largest * unitMeters) - kRangeLowest));
    packed.rangeCode = uint8_t(std::clamp(code, 0.0f, 255.0f));
    const float range = rangeOf(packed.rangeCode, unitMeters);
    for (size_t i = 0; i < reciprocal.size(); ++i)
        packed.code[i] = uint8_t(std::lround(255 * std::min(reciprocal[i] / range, 1.0f)));
    return packed;
}

float probeVisibility(const ProbeDistances& distances, glm::vec3 offset, float unitMeters) {
    const float t = std::abs(offset.x) + std::abs(offset.y) + std::abs(offset.z);
    if (t <= 0.0f) return 1.0f;
    // All four quarters of the square are mirrored to the first, in which the octahedron's edges run from x
    // to y, as the diagonals that divide the intervals' squares do.
    glm::vec2 square = glm::abs(glm::vec2(offset)) / t;
    if (offset.z < 0.0f) square = 1.0f - glm::vec2(square.y, square.x);
    const glm::vec2 at = float(kDistanceIntervals) * square;
    const glm::ivec2 corner = glm::min(glm::ivec2(at), glm::ivec2(kDistanceIntervals - 1));
    const glm::vec2 f = at - glm::vec2(corner);
    const glm::ivec2 mirror(offset.x < 0.0f ? -1 : 1, offset.y < 0.0f ? -1 : 1);
    const auto code = [&](int x, int y) {
        const glm::ivec2 node = kDistanceIntervals + mirror * (corner + glm::ivec2(x, y));
        return float(distances.code[size_t(node.y * kDistanceNodes + node.x)]);
    };
    const float diagonal = f.x + f.y;
    const float mean = diagonal <= 1.0f ? (1.0f - diagonal) * code(0, 0) + f.x * code(1, 0) + f.y * code(0, 1)
                                        : (diagonal - 1.0f) * code(1, 1) + (1.0f - f.x) * code(0, 1) +
                                              (1.0f - f.y) * code(1, 0);
    const float depth = t * mean / 255.0f * rangeOf(distances.rangeCode, unitMeters);
    const float seen = std::clamp((kHiddenFrom - depth) / (kHiddenFrom - kSeenWithin), 0.0f, 1.0f);
    const float hidden = kHiddenWeight * std::exp2(kHiddenHalvings * std::min(kHiddenFrom - depth, 0.0f));
    return std::max({seen, hidden, kMinWeight});
}

}  // namespace phat
