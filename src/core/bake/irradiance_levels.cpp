#include "core/bake/irradiance_levels.h"

#include <optional>

#include "core/atlas/chart_fill.h"
#include "core/atlas/texel_neighbors.h"
#include "core/base/parallel.h"
#include "core/base/plane_fit.h"

namespace phat {
namespace {

// Radii of the neighbourhood: from the least that holds a plane and some rays, in steps of the node's level,
// by this ratio to the largest, in steps again and in texels.
constexpr float kMinRadiusSteps = 2.0f;
constexpr float kRadiusRatio = 1.5f;
constexpr float kMaxRadiusSteps = 12.0f;
constexpr float kMaxRadiusTexels = 32.0f;
// Nor beyond this fraction of the largest harmonic mean distance in that neighbourhood: a plane over
// irradiance that bends as quickly as what it sees is near then misses by (1/4)^2 / 8, under 1 %.
constexpr float kMaxRadiusOverDistance = 0.25f;
// Between smooth nodes: at least two in each direction.
constexpr float kBetweenSteps = 1.7f;
// Half the width of the confidence intervals that must meet, standard errors.
constexpr float kConfidence = 3.0f;
// A node so many standard errors above its neighbours is an outlier: one of its rays hit a rare bright
// surface.
constexpr float kOutlierErrors = 6.0f;
// Lower bound of the relative standard error: a third of a percent is invisible.
constexpr float kMinFitRelativeError = 0.003f;
// Normals farther apart than this are different surfaces to the light.
constexpr float kMinFitNormalCosine = 0.9f;
// Costs in rays: the fit that estimates a node's noise, a node's smoothing, a texel.
constexpr uint64_t kNoiseWork = 4, kSmoothWork = 40, kTexelWork = 1;

/// One value a node, [level][node].
template <typename Value>
using PerNode = std::vector<std::vector<Value>>;

template <typename Value>
PerNode<Value> makePerNode(const std::vector<IrradianceLevel>& levels) {
    PerNode<Value> result;
    for (const IrradianceLevel& level : levels) result.emplace_back(level.texel.size(), Value(0));
    return result;
}

/// A node near a texel, of its piece of surface.
struct Neighbor {
    uint32_t level, node;
    glm::vec2 texels;  // from the texel to the node
    float alike;       // of the normals
    bool split;        // there are finer nodes in the same group
};

/// Calls visit(neighbor, weight, offset) if it is nearer than a radius; the offset is in radii.
template <typename Visit>
void visitWithin(float radius, const Neighbor& neighbor, const Visit& visit) {
    const glm::vec2 offset = neighbor.texels / radius;
    const float fall = 1.0f - glm::dot(offset, offset);
    if (fall > 0.0f) visit(neighbor, fall * fall * neighbor.alike, offset);
}

/// Each step takes what the one before it found for all nodes.
class Interpolator {
  public:
    Interpolator(const std::vector<IrradianceLevel>& levels, const Atlas& atlas, const TexelPoints& points)
        : levels_(levels), atlas_(atlas), points_(points) {
        for (const IrradianceLevel& level : levels_) values_.push_back(level.value);
    }

    /// Variance of the luminance that the narrowest fit around a node leaves unexplained.
    float noise(size_t level, uint32_t node) const {
        const float radius = kMinRadiusSteps * stepOf(level);
        PlaneFit fit;
        around(levels_[level].texel[node], radius, [&](const Neighbor& near, float weight, glm::vec2 offset) {
            fit.add(weight, offset, values_[near.level][near.node]);
        });
        return fit.atOrigin().residual;
    }

    /// The excess of a node over its neighbours, if it is not noise.
    glm::vec3 outlyingPart(size_t level, uint32_t node, const PerNode<float>& noise) const {
        const glm::vec3 value = values_[level][node];
        const uint32_t texel = levels_[level].texel[node];
        const float narrow = kMinRadiusSteps * stepOf(level), wide = widestRadius(level);
        PlaneFit others;
        around(texel, narrow, [&](const Neighbor& near, float weight, glm::vec2 offset) {
            if (near.level != level || near.node != node)
                others.add(weight, offset, values_[near.level][near.node]);
        });
        if (others.empty()) return glm::vec3(0);
        const float light = luminance(value), expected = luminance(others.atOrigin().value);
        // The cheaper test first: an outlier also exceeds the noise of its own node.
        if (light - expected <= 2.0f * std::sqrt(noise[level][node])) return glm::vec3(0);
        const float noiseAround = meanNoise(neighborsOf(texel, wide), wide, noise);
        if (light - expected <= kOutlierErrors * std::sqrt(noiseAround)) return glm::vec3(0);
        return value * (1.0f - expected / light);
    }

    /// Spreads the outlying parts over the neighbourhoods. Returns whether there were any: the noise is then
    /// another one.
    bool redistribute(const PerNode<glm::vec3>& outlying) {
        bool any = false;
        for (size_t level = 0; level < levels_.size(); ++level)
            for (uint32_t node = 0; node < outlying[level].size(); ++node) {
                if (outlying[level][node] == glm::vec3(0)) continue;
                redistribute(level, node, outlying[level][node]);
                any = true;
            }
        return any;
    }

    /// The widest fit that agrees with all narrower ones: the confidence intervals of all still
    /// intersect. source: Katkovnik 1999, "A new method for varying adaptive bandwidth selection".
    glm::vec3 smoothed(size_t level, uint32_t node, const PerNode<float>& noiseOfNodes) const {
        const float narrowest = kMinRadiusSteps * stepOf(level), wide = widestRadius(level);
        const std::vector<Neighbor> neighbors = neighborsOf(levels_[level].texel[node], wide);
        const float noise = noiseAt(neighbors, {narrowest, wide}, noiseOfNodes);
        float distance = 0;
        for (const Neighbor& near : neighbors)
            distance = std::max(distance, levels_[near.level].distanceTexels[near.node]);
        const float widest = std::clamp(kMaxRadiusOverDistance * distance, narrowest, wide);
        glm::vec3 best = values_[level][node];
        float low = -1e30f, high = 1e30f;
        for (float radius = narrowest; radius <= widest; radius *= kRadiusRatio) {
            const PlaneFit::Estimate estimate = fitWithin(neighbors, radius).atOrigin();
            const float light = luminance(estimate.value);
            const float error = kConfidence * std::sqrt(noise * estimate.varianceFraction +
                                                        square(kMinFitRelativeError * light));
            low = std::max(low, light - error);
            high = std::min(high, light + error);
            if (low > high) break;
            best = estimate.value;
        }
        return best;
    }

    /// Nothing where no node of the texel's piece of surface is near.
    std::optional<glm::vec3> at(uint32_t texel, const PerNode<glm::vec3>& smooth) const {
        if (levels_[0].node[levels_[0].groupOf(texel, atlas_.sizeTexels.x)] == kNoNode) return std::nullopt;
        size_t own = 0;
        uint32_t node = nodeAt(0, texel);
        for (uint32_t finer = node; own + 1 < levels_.size(); ++own) {
            finer = nodeAt(own + 1, texel);
            if (finer == kNoNode) break;
            node = finer;
        }
        if (node != kNoNode && levels_[own].texel[node] == texel) return smooth[own][node];
        PlaneFit fit;
        const float radius = kBetweenSteps * float(levels_[own].step);
        // Between nodes only the finest count: the others are smoothed more.
        around(texel, radius, [&](const Neighbor& near, float weight, glm::vec2 offset) {
            if (!near.split) fit.add(weight, offset, smooth[near.level][near.node]);
        });
        if (!fit.empty()) return fit.atOrigin().value;
        // On a crease no node may have a similar normal.
        return node != kNoNode ? std::optional(smooth[own][node]) : std::nullopt;
    }

  private:
    float stepOf(size_t level) const { return float(levels_[level].step); }
    float widestRadius(size_t level) const {
        return std::min(kMaxRadiusSteps * stepOf(level), kMaxRadiusTexels);
    }

    /// pre: `radius` is at most that of the neighbourhood.
    PlaneFit fitWithin(const std::vector<Neighbor>& neighbors, float radius) const {
        PlaneFit fit;
        for (const Neighbor& each : neighbors)
            visitWithin(radius, each, [&](const Neighbor& near, float weight, glm::vec2 offset) {
                fit.add(weight, offset, values_[near.level][near.node]);
            });
        return fit;
    }

    /// Firefly redistribution: a rare bright ray makes an outlier that no smoothing removes, because it
    /// agrees with no wider fit. Its excess is spread over the neighbourhood, which preserves the sum.
    void redistribute(size_t level, uint32_t node, glm::vec3 excess) {
        const float radius = widestRadius(level);
        float area = 0;  // texels, by weight
        bool split = false;
        around(levels_[level].texel[node], radius, [&](const Neighbor& near, float weight, glm::vec2) {
            area += weight * texelsOf(near);
            if (near.level == level && near.node == node) split = near.split;
        });
        const glm::vec3 perTexel = excess * texelsOf({uint32_t(level), node, {}, 1.0f, split}) / area;
        values_[level][node] -= excess;
        around(levels_[level].texel[node], radius, [&](const Neighbor& near, float weight, glm::vec2) {
            values_[near.level][near.node] += weight * perTexel;
        });
    }
    /// For how many a node stands: with finer nodes in its group, for as many as each of these.
    float texelsOf(const Neighbor& node) const {
        return square(stepOf(node.level)) * (node.split ? 0.2f : 1.0f);
    }

    /// Variance of the values around a node: the mean over the neighbourhood. By its own estimate a node that
    /// the rare bright rays missed would seem free of noise, and the result would be too dark.
    float meanNoise(const std::vector<Neighbor>& neighbors, float radius, const PerNode<float>& noise) const {
        float sum = 0, weights = 0;
        for (const Neighbor& each : neighbors)
            visitWithin(radius, each, [&](const Neighbor& near, float weight, glm::vec2) {
                sum += weight * noise[near.level][near.node];
                weights += weight;
            });
        return sum / weights;
    }

    /// The same in proportion to the light, as noise mostly is, if that is less: what nodes in a bright gap
    /// have would let everything beside it pass for noise. radii: the narrowest, the widest.
    float noiseAt(const std::vector<Neighbor>& neighbors, glm::vec2 radii,
                  const PerNode<float>& noise) const {
        const float light = luminance(fitWithin(neighbors, radii.x).atOrigin().value);
        float relative = 0, weights = 0;
        for (const Neighbor& each : neighbors)
            visitWithin(radii.y, each, [&](const Neighbor& near, float weight, glm::vec2) {
                const float other = luminance(values_[near.level][near.node]);
                if (other <= 0.0f) return;
                relative += weight * noise[near.level][near.node] / square(other);
                weights += weight;
            });
        const float mean = meanNoise(neighbors, radii.y, noise);
        return weights > 0.0f ? std::min(mean, square(light) * relative / weights) : mean;
    }

    uint32_t nodeAt(size_t level, uint32_t texel) const {
        return levels_[level].nodeOf(atlas_, points_, texel);
    }
    glm::ivec2 positionOf(uint32_t texel) const {
        return {texel % atlas_.sizeTexels.x, texel / atlas_.sizeTexels.x};
    }

    /// Calls visit(neighbor) for the nodes around a texel of its piece of surface.
    template <typename Visit>
    void forNeighbors(uint32_t texel, float radius, const Visit& visit) const {
        const glm::ivec2 center = positionOf(texel);
        const uint32_t chart = atlas_.chartAt(center);
        const glm::ivec2 low(atlas_.charts[chart].originTexel());
        const glm::ivec2 high = low + glm::ivec2(atlas_.charts[chart].sizeTexels()) - 1;
        const TexelPlane plane(atlas_, points_, texel);
        const int reach = int(radius);
        const glm::ivec2 from = glm::max(center - reach, low) / int(kLevelSteps[0]);
        const glm::ivec2 to = glm::min(center + reach, high) / int(kLevelSteps[0]);
        const auto visitNode = [&](size_t level, uint32_t node, bool split) {
            const uint32_t other = levels_[level].texel[node];
            const glm::vec2 texels(positionOf(other) - center);
            if (glm::dot(texels, texels) >= square(radius)) return;
            const float cosine = glm::dot(points_.normal[texel], points_.normal[other]);
            const float alike = (cosine - kMinFitNormalCosine) / (1.0f - kMinFitNormalCosine);
            if (alike > 0.0f && plane.has(other, texels))
                visit(Neighbor{uint32_t(level), node, texels, alike, split});
        };
        for (int y = from.y; y <= to.y; ++y)
            for (int x = from.x; x <= to.x; ++x)
                if (atlas_.chartAt(glm::uvec2(x, y) * kLevelSteps[0]) == chart) descend(0, {x, y}, visitNode);
    }

    /// For those that are looked at more than once.
    std::vector<Neighbor> neighborsOf(uint32_t texel, float radius) const {
        std::vector<Neighbor> found;
        const int across = 2 * int(radius) / int(kLevelSteps[0]) + 1;
        found.reserve(size_t(across) * across);
        forNeighbors(texel, radius, [&](const Neighbor& near) { found.push_back(near); });
        return found;
    }

    /// Calls visit(neighbor, weight, offset) as visitWithin does.
    template <typename Visit>
    void around(uint32_t texel, float radius, const Visit& visit) const {
        forNeighbors(texel, radius, [&](const Neighbor& near) { visitWithin(radius, near, visit); });
    }

    template <typename Visit>
    bool descend(size_t level, glm::uvec2 group, const Visit& visit) const {
        const IrradianceLevel& here = levels_[level];
        uint32_t node = here.node[size_t(group.y) * here.size.x + group.x];
        if (node == kNoNode) return false;
        bool split = false;
        if (level + 1 < levels_.size())
            for (uint32_t i = 0; i < 4; ++i)
                split |= descend(level + 1, 2u * group + glm::uvec2(i & 1, i >> 1), visit);
        for (; node != kNoNode; node = here.next[node]) visit(level, node, split);
        return true;
    }

    const std::vector<IrradianceLevel>& levels_;
    const Atlas& atlas_;
    const TexelPoints& points_;
    PerNode<glm::vec3> values_;  // outliers redistributed
};

}  // namespace

ResumableTask interpolateLevels(const std::vector<IrradianceLevel>& levels, const Atlas& atlas,
                                const TexelPoints& points, const ChartSet& charts, IrradianceMap& map,
                                uint64_t sliceWork) {
    Interpolator interpolator(levels, atlas, points);
    SilentProgress silent;
    const auto forNodes = [&](auto& results, auto resultOf, uint64_t itemWork) -> ResumableTask {
        const size_t most = itemsPerSlice(sliceWork, itemWork);
        for (size_t level = 0; level < levels.size(); ++level) {
            const std::vector<uint32_t>& texel = levels[level].texel;
            for (size_t first = 0, last = 0; first < texel.size(); first = last) {
                last = first + std::min(most, texel.size() - first);
                parallelRanges(last - first, 256, silent, [&](size_t begin, size_t end) {
                    for (size_t node = first + begin; node < first + end; ++node)
                        if (hasChart(charts, atlas.chartAt(size_t(texel[node]))))
                            results[level][node] = resultOf(level, uint32_t(node));
                });
                co_yield (itemWork * (last - first));
            }
        }
    };
    const auto noiseOf = [&](size_t level, uint32_t node) { return interpolator.noise(level, node); };
    auto noise = makePerNode<float>(levels);
    auto outlying = makePerNode<glm::vec3>(levels), smooth = makePerNode<glm::vec3>(levels);
    for (ResumableTask task = forNodes(noise, noiseOf, kNoiseWork); task.next();) co_yield task.work();
    const auto outlyingOf = [&](size_t level, uint32_t node) {
        return interpolator.outlyingPart(level, node, noise);
    };
    for (ResumableTask task = forNodes(outlying, outlyingOf, kNoiseWork); task.next();) co_yield task.work();
    if (interpolator.redistribute(outlying))
        for (ResumableTask task = forNodes(noise, noiseOf, kNoiseWork); task.next();) co_yield task.work();
    const auto smoothOf = [&](size_t level, uint32_t node) {
        return interpolator.smoothed(level, node, noise);
    };
    for (ResumableTask task = forNodes(smooth, smoothOf, kSmoothWork); task.next();) co_yield task.work();
    map.assign(atlas.texelCount(), glm::vec3(0));
    std::vector<uint8_t> known(map.size(), 0);
    const size_t most = itemsPerSlice(sliceWork, kTexelWork);
    for (size_t first = 0, last = 0; first < map.size(); first = last) {
        last = first + std::min(most, map.size() - first);
        parallelRanges(last - first, 4096, silent, [&](size_t begin, size_t end) {
            for (size_t i = first + begin; i < first + end; ++i) {
                if (!hasChart(charts, atlas.chartAt(i))) {
                    known[i] = 1;  // nothing to fill
                    continue;
                }
                if (!points.valid(i)) continue;
                const std::optional<glm::vec3> value = interpolator.at(uint32_t(i), smooth);
                map[i] = value.value_or(glm::vec3(0));
                known[i] = value.has_value();
            }
        });
        co_yield (kTexelWork * (last - first));
    }
    fillWithinCharts(map, known, atlas, points);
}

}  // namespace phat
