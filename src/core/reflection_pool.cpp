#include "core/reflection_pool.h"

namespace phat {
namespace {

// A neighbour whose lobe is so many of one's own widths away sees other things, and so does one whose lobe is
// so much wider or narrower.
constexpr float kPoolWidthPerAlpha = 0.8f;
constexpr float kMostTimesAlpha = 1.5f;
// A mirror is sharper than a pixel; it needs no other's rays.
constexpr float kLeastAlpha = 0.005f;

}  // namespace

ReflectionPool::ReflectionPool(std::vector<PooledLobe> lobes, int width, int height)
    : lobes_(std::move(lobes)),
      lobeOf_(size_t(width) * size_t(height), kNoLobe),
      width_(width),
      height_(height) {
    for (uint32_t i = 0; i < lobes_.size(); ++i)
        if (lobes_[i].alpha > 0) lobeOf_[lobes_[i].pixel] = i;
}

float ReflectionPool::likeness(const PooledLobe& mine, const PooledLobe& other) {
    if (&mine == &other) return 1;
    if (mine.side != other.side || mine.alpha < kLeastAlpha) return 0;
    if (std::max(mine.alpha, other.alpha) > kMostTimesAlpha * std::min(mine.alpha, other.alpha)) return 0;
    // What one sees in its mirror direction, the other sees turned by its own turn and by the step between
    // them.
    glm::vec3 step = (other.position - mine.position) / mine.distance;
    step -= glm::dot(step, mine.mirror) * mine.mirror;
    const glm::vec3 apart = (other.mirror - mine.mirror + step) / (kPoolWidthPerAlpha * mine.alpha);
    return std::exp(-0.5f * glm::dot(apart, apart));
}

float ReflectionPool::raysForOne(size_t i) const {
    float sum = 0;
    visit(i, [&](size_t, float weight) { sum += weight; });
    return sum / float((kReach + 1) * (kReach + 1));
}

}  // namespace phat
