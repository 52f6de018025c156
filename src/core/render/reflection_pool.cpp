#include "core/render/reflection_pool.h"

#include "core/base/math.h"

namespace phat {
namespace {

// A neighbour whose lobe is so many of one's own widths away sees other things, and so does one whose lobe is
// so much wider or narrower.
constexpr float kPoolWidthPerAlpha = 0.8f;
constexpr float kMostTimesAlpha = 1.5f;
// A mirror is sharper than a pixel; it needs no other's rays.
constexpr float kLeastAlpha = 0.005f;
// A line, one pixel wide, is four times as bright as the mean around.
constexpr float kMostTimesNear = 4.0f;
// What is given away may add so much of the mean around in the middle.
constexpr float kMostGiven = 1.0f;

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
    if (mine.alpha < kLeastAlpha) return 0;
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
    return sum / kOwnTent;
}

PooledLight ReflectionPool::pooled(size_t i, const std::vector<PooledLight>& lights,
                                   const std::vector<Share>& shares) const {
    PooledLight sum;
    visit(i, [&](size_t j, float likeness) {
        const PooledLight& light = lights[j];
        const float weight = likeness * light.weight;
        sum.weight += weight;
        sum.indirect += weight * shares[j].kept * light.indirect;
        sum.area += weight * light.area;
    });
    if (sum.weight <= 0.0f) return {};
    sum.indirect /= sum.weight;
    sum.area /= sum.weight;
    visitNear(i, [&](size_t j, float tent) { sum.indirect += tent * shares[j].given; });
    return sum;
}

ReflectionPool::Share ReflectionPool::shareOut(size_t i, const std::vector<PooledLight>& lights) const {
    float light = 0, weights = 0;  // of those around
    visitNear(i, [&](size_t j, float tent) {
        if (j == i) return;
        light += tent * lights[j].weight * luminance(lights[j].indirect);
        weights += tent * lights[j].weight;
    });
    if (weights <= 0.0f) return {};
    const PooledLight& mine = lights[i];
    const float mean = light / weights, own = luminance(mine.indirect);
    if (own <= kMostTimesNear * mean) return {};
    const float kept = kMostTimesNear * mean / own;
    const float part = mine.weight / (weights + kOwnTent * mine.weight);
    const float shown = kOwnTent * (1.0f - kept) * part * own;
    const float scale = std::min(1.0f, kMostGiven * mean / shown);
    return {kept, scale * (1.0f - kept) * part * mine.indirect};
}

}  // namespace phat
