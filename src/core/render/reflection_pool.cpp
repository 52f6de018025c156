#include "core/render/reflection_pool.h"

#include "core/base/math.h"

namespace phat {
namespace {

// Width of the Gaussian by which a neighbour is weighted, in units of alpha, and the greatest ratio of the
// two lobes' alphas: beyond, the neighbour reflects other things.
constexpr float kPoolWidthPerAlpha = 0.8f;
constexpr float kMaxAlphaRatio = 1.5f;
// A bright line of one pixel's width is four times as bright as the mean around it.
constexpr float kMaxOverNeighbors = 4.0f;
// The redistributed light adds at most this fraction of the neighbours' mean at the centre: a clamp.
constexpr float kMaxRedistributed = 1.0f;

// At a grazing angle a lobe is narrower from side to side, by the cosine: what differences are multiplied by
// for that. The normals of a rough surface are seen less aslant than its plane is. source: the change of a
// mirror direction by a turn of the normal, about the axis in the plane of incidence and across it; that
// roughness counts as alpha^2 is ours.
glm::vec3 squeezeOf(const PooledLobe& lobe) {
    const glm::vec3 across = glm::cross(lobe.towardEye, lobe.mirror);
    const float squared =
        std::min(0.5f + 0.5f * glm::dot(lobe.towardEye, lobe.mirror) + lobe.alpha * lobe.alpha, 1.0f);
    return across * std::sqrt((1.0f / squared - 1.0f) / std::max(glm::dot(across, across), 1e-4f));
}

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
    if (mine.alpha < kMinPooledAlpha) return 0;
    if (std::max(mine.alpha, other.alpha) > kMaxAlphaRatio * std::min(mine.alpha, other.alpha)) return 0;
    // Parallax: a point in one lobe's mirror direction appears to the other rotated by the difference of
    // their mirror directions and by the step between their positions.
    glm::vec3 step = (other.position - mine.position) / mine.distance;
    step -= glm::dot(step, mine.mirror) * mine.mirror;
    const glm::vec3 apart = (other.mirror - mine.mirror + step) / (kPoolWidthPerAlpha * mine.alpha);
    return std::exp(-0.5f * (glm::dot(apart, apart) + square(glm::dot(apart, squeezeOf(mine)))));
}

ReflectionPool::Steps ReflectionPool::steps(size_t i) const {
    const PooledLobe& mine = lobes_[i];
    const int x = int(mine.pixel) % width_, y = int(mine.pixel) / width_;
    Steps steps;
    for (int axis = 0; axis < 2; ++axis)
        for (const int sign : {1, -1}) {
            const int u = x + (axis == 0 ? sign : 0), v = y + (axis == 1 ? sign : 0);
            if (u < 0 || v < 0 || u >= width_ || v >= height_) continue;
            const uint32_t j = lobeOf_[size_t(v) * size_t(width_) + size_t(u)];
            if (j == kNoLobe || lobes_[j].side != mine.side) continue;
            steps.position[axis] = lobes_[j].position - mine.position;
            steps.mirror[axis] = lobes_[j].mirror - mine.mirror;
            break;
        }
    return steps;
}

float ReflectionPool::raysForOne(size_t i) const {
    float sum = 0;
    visit(i, [&](size_t, float weight) { sum += weight; });
    return sum / kOwnTent;
}

PooledLight ReflectionPool::pooled(size_t i, const std::vector<PooledLight>& lights,
                                   const std::vector<Redistribution>& redistributions) const {
    PooledLight sum;
    visit(i, [&](size_t j, float likeness) {
        const PooledLight& light = lights[j];
        const float weight = likeness * light.weight;
        sum.weight += weight;
        sum.indirect += weight * redistributions[j].retained * light.indirect;
        sum.area += weight * light.area;
    });
    if (sum.weight <= 0.0f) return {};
    sum.indirect /= sum.weight;
    sum.area /= sum.weight;
    visitNear(i, [&](size_t j, float tent) { sum.indirect += tent * redistributions[j].spread; });
    return sum;
}

ReflectionPool::Redistribution ReflectionPool::redistribute(size_t i,
                                                            const std::vector<PooledLight>& lights) const {
    float light = 0, weights = 0;  // of those around
    visitNear(i, [&](size_t j, float tent) {
        if (j == i) return;
        light += tent * lights[j].weight * luminance(lights[j].indirect);
        weights += tent * lights[j].weight;
    });
    if (weights <= 0.0f) return {};
    const PooledLight& mine = lights[i];
    const float mean = light / weights, own = luminance(mine.indirect);
    if (own <= kMaxOverNeighbors * mean) return {};
    const float retained = kMaxOverNeighbors * mean / own;
    const float part = mine.weight / (weights + kOwnTent * mine.weight);
    const float added = kOwnTent * (1.0f - retained) * part * own;
    const float scale = std::min(1.0f, kMaxRedistributed * mean / added);
    return {retained, scale * (1.0f - retained) * part * mine.indirect};
}

}  // namespace phat
