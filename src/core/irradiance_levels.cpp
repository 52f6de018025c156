#include "core/irradiance_levels.h"

#include "core/chart_fill.h"
#include "core/parallel.h"

namespace phat {
namespace {

// Radii of the neighbourhood: from the least that holds a plane and some rays, in steps of the node's level,
// by this ratio to the largest, in steps again and in texels.
constexpr float kMinRadiusSteps = 2.0f;
constexpr float kRadiusRatio = 1.5f;
constexpr float kMaxRadiusSteps = 12.0f;
constexpr float kMaxRadiusTexels = 32.0f;
// Nor beyond this share of the largest harmonic mean distance in that neighbourhood: a plane over irradiance
// that bends as quickly as what it sees is near then misses by (1/4)^2 / 8, under 1 %.
constexpr float kMaxRadiusOverDistance = 0.25f;
// Between smooth nodes: at least two in each direction.
constexpr float kBetweenSteps = 1.7f;
// Half the width of the confidence intervals that must meet, standard errors.
constexpr float kConfidence = 3.0f;
// A node that lies so many standard errors above its neighbours had a ray that the others missed.
constexpr float kOutlierErrors = 6.0f;
// Estimates are never taken to be better than this: a third of a percent cannot be seen.
constexpr float kLeastRelativeError = 0.003f;
// Normals farther apart than this are different surfaces to the light.
constexpr float kLeastNormalCosine = 0.9f;
// Variance added to the offsets, of the squared radius: a handful of nodes in a row make no plane.
constexpr float kRidge = 0.01f;

/// A weighted plane through values, read at the origin.
class PlaneFit {
  public:
    void add(float weight, glm::vec2 offset, glm::vec3 value) {
        const float light = luminance(value);
        weights_ += weight;
        weightsSquared_ += weight * weight;
        lightSquared_ += weight * light * light;
        offset_ += weight * offset;
        xx_ += weight * offset.x * offset.x;
        xy_ += weight * offset.x * offset.y;
        yy_ += weight * offset.y * offset.y;
        value_ += weight * value;
        valueX_ += weight * offset.x * value;
        valueY_ += weight * offset.y * value;
        low_ = glm::min(low_, value);
        high_ = glm::max(high_, value);
    }
    bool empty() const { return weights_ <= 0.0f; }

    struct Estimate {
        glm::vec3 value;
        float residual;  // variance of the values' luminance that the plane leaves unexplained
        float share;     // of the values' variance that is left in the estimate
    };
    /// pre: not empty().
    Estimate atOrigin() const {
        const glm::vec2 m = offset_ / weights_;
        const glm::vec3 mean = value_ / weights_;
        const float xx = xx_ / weights_ - m.x * m.x + kRidge, yy = yy_ / weights_ - m.y * m.y + kRidge;
        const float xy = xy_ / weights_ - m.x * m.y;
        const glm::vec3 vx = valueX_ / weights_ - m.x * mean, vy = valueY_ / weights_ - m.y * mean;
        const float determinant = xx * yy - xy * xy;
        const glm::vec3 slopeX = (yy * vx - xy * vy) / determinant;
        const glm::vec3 slopeY = (xx * vy - xy * vx) / determinant;

        const float residual = lightSquared_ / weights_ - square(luminance(mean)) -
                               luminance(slopeX) * luminance(vx) - luminance(slopeY) * luminance(vy);
        const float leverage = 1.0f + (yy * m.x * m.x - 2.0f * xy * m.x * m.y + xx * m.y * m.y) / determinant;
        // Never beyond what was seen: outside the nodes a plane may go anywhere.
        return {glm::clamp(mean - m.x * slopeX - m.y * slopeY, low_, high_), std::max(residual, 0.0f),
                leverage * weightsSquared_ / square(weights_)};
    }

  private:
    float weights_ = 0, weightsSquared_ = 0, lightSquared_ = 0, xx_ = 0, xy_ = 0, yy_ = 0;
    glm::vec2 offset_{0};
    glm::vec3 value_{0}, valueX_{0}, valueY_{0};
    glm::vec3 low_{1e30f}, high_{-1e30f};
};

class Interpolator {
  public:
    Interpolator(const std::vector<IrradianceLevel>& levels, const Atlas& atlas, const TexelPoints& points,
                 const ChartSet& charts)
        : levels_(levels), atlas_(atlas), points_(points), charts_(charts) {
        for (const IrradianceLevel& level : levels) values_.push_back(level.value);
        measureNoise();
        if (spreadOutliers()) measureNoise();
        smooth_ = forNodes<glm::vec3>(
            [&](const IrradianceLevel& level, uint32_t node) { return smoothed(level, node); });
    }

    /// Whether the texel's group of the coarsest level has a node.
    bool hasNode(uint32_t texel) const { return nodeAt(0, texel) != kNoNode; }
    /// pre: hasNode(texel).
    glm::vec3 at(uint32_t texel) const {
        size_t own = 0;
        while (own + 1 < levels_.size() && nodeAt(own + 1, texel) != kNoNode) ++own;
        const uint32_t node = nodeAt(own, texel);
        if (levels_[own].texel[node] == texel) return smooth_[own][node];
        PlaneFit fit;
        // Between nodes only the finest count: the others are smoothed more.
        gather(texel, kBetweenSteps * float(levels_[own].step),
               [&](size_t l, uint32_t n, bool split, float weight, glm::vec2 offset) {
                   if (!split) fit.add(weight, offset, smooth_[l][n]);
               });
        // On a crease no node may face the same way.
        return fit.empty() ? smooth_[own][node] : fit.atOrigin().value;
    }

  private:
    template <typename Value, typename Make>
    std::vector<std::vector<Value>> forNodes(const Make& make) const {
        std::vector<std::vector<Value>> made;
        SilentProgress silent;
        for (const IrradianceLevel& level : levels_) {
            std::vector<Value>& values = made.emplace_back(level.texel.size());
            parallelRanges(values.size(), 256, silent, [&](size_t begin, size_t end) {
                for (size_t i = begin; i < end; ++i)
                    if (hasChart(charts_, atlas_.chartAt(placeOf(level.texel[i]))))
                        values[i] = make(level, uint32_t(i));
            });
        }
        return made;
    }

    PlaneFit fitAround(const IrradianceLevel& level, uint32_t node, float radius,
                       bool withItself = true) const {
        PlaneFit fit;
        gather(level.texel[node], radius, [&](size_t l, uint32_t n, bool, float weight, glm::vec2 offset) {
            if (withItself || &levels_[l] != &level || n != node) fit.add(weight, offset, values_[l][n]);
        });
        return fit;
    }

    void measureNoise() {
        noise_ = forNodes<float>([&](const IrradianceLevel& level, uint32_t node) {
            return fitAround(level, node, kMinRadiusSteps * float(level.step)).atOrigin().residual;
        });
    }

    static float widestAround(const IrradianceLevel& level) {
        return std::min(kMaxRadiusSteps * float(level.step), kMaxRadiusTexels);
    }

    /// What a node has more than its neighbours, if that is no noise.
    glm::vec3 outlyingPart(const IrradianceLevel& level, uint32_t node) const {
        const size_t l = size_t(&level - levels_.data());
        const glm::vec3 value = values_[l][node];
        const PlaneFit others = fitAround(level, node, kMinRadiusSteps * float(level.step), false);
        const float light = luminance(value);
        const float expected = others.empty() ? light : luminance(others.atOrigin().value);
        // An outlier is a part of the noise at its own place: the cheaper question first.
        if (light - expected <= 2.0f * std::sqrt(noise_[l][node])) return glm::vec3(0);
        const float noise = noiseAround(level, node, widestAround(level));
        if (square(light - expected) <= square(kOutlierErrors) * noise) return glm::vec3(0);
        return value * (1.0f - expected / light);
    }

    /// A ray that meets a rare bright thing makes a spot that no smoothing removes, because it agrees with no
    /// wider fit. Its light is shared out to all around, so that none is lost: it stands for what they
    /// missed. Returns whether there was any.
    bool spreadOutliers() {
        const auto outlying = forNodes<glm::vec3>(
            [&](const IrradianceLevel& level, uint32_t node) { return outlyingPart(level, node); });
        bool any = false;
        for (size_t l = 0; l < levels_.size(); ++l) {
            for (size_t node = 0; node < outlying[l].size(); ++node) {
                if (outlying[l][node] == glm::vec3(0)) continue;
                any = true;
                spread(l, node, outlying[l][node]);
            }
        }
        return any;
    }

    void spread(size_t l, size_t node, glm::vec3 excess) {
        const IrradianceLevel& level = levels_[l];
        const float radius = widestAround(level);
        float area = 0;  // texels, by weight
        gather(level.texel[node], radius, [&](size_t l2, uint32_t, bool split, float weight, glm::vec2) {
            if (!split) area += weight * square(float(levels_[l2].step));
        });
        const glm::vec3 share = excess * square(float(level.step)) / area;
        values_[l][node] -= excess;
        gather(level.texel[node], radius, [&](size_t l2, uint32_t n, bool, float weight, glm::vec2) {
            values_[l2][n] += weight * share;
        });
    }

    /// Variance of the values around a node. The mean over many: with an estimate of its own, a place that a
    /// rare bright ray missed would seem to be quiet, and be taken at its word.
    float noiseAround(const IrradianceLevel& level, uint32_t node, float radius) const {
        float sum = 0, weights = 0;
        gather(level.texel[node], radius, [&](size_t l, uint32_t n, bool, float weight, glm::vec2) {
            sum += weight * noise_[l][n];
            weights += weight;
        });
        return sum / weights;
    }

    float largestDistanceAround(const IrradianceLevel& level, uint32_t node, float radius) const {
        float largest = 0;
        gather(level.texel[node], radius, [&](size_t l, uint32_t n, bool, float, glm::vec2) {
            largest = std::max(largest, levels_[l].distanceTexels[n]);
        });
        return largest;
    }

    /// The widest fit that agrees with all narrower ones: the confidence intervals of all still have a place
    /// in common. source: Katkovnik 1999, "A new method for varying adaptive bandwidth selection".
    glm::vec3 smoothed(const IrradianceLevel& level, uint32_t node) const {
        const float step = float(level.step);
        const float around = widestAround(level);
        const float noise = noiseAround(level, node, around);
        const float widest = std::clamp(kMaxRadiusOverDistance * largestDistanceAround(level, node, around),
                                        kMinRadiusSteps * step, around);
        glm::vec3 best = values_[size_t(&level - levels_.data())][node];
        float low = -1e30f, high = 1e30f;
        for (float radius = kMinRadiusSteps * step; radius <= widest; radius *= kRadiusRatio) {
            const PlaneFit::Estimate estimate = fitAround(level, node, radius).atOrigin();
            const float light = luminance(estimate.value);
            const float error =
                kConfidence * std::sqrt(noise * estimate.share + square(kLeastRelativeError * light));
            low = std::max(low, light - error);
            high = std::min(high, light + error);
            if (low > high) break;
            best = estimate.value;
        }
        return best;
    }

    uint32_t nodeAt(size_t level, uint32_t texel) const {
        return levels_[level].node[levels_[level].groupOf(texel, atlas_.sizeTexels.x)];
    }
    glm::ivec2 placeOf(uint32_t texel) const {
        return {texel % atlas_.sizeTexels.x, texel / atlas_.sizeTexels.x};
    }

    /// Calls add(level, node, split, weight, offset) for the nodes around a texel; split: there are finer
    /// nodes in the same group; the offset is in radii.
    template <typename Add>
    void gather(uint32_t texel, float radius, const Add& add) const {
        const glm::ivec2 center = placeOf(texel);
        const uint32_t chart = atlas_.chartAt(center);
        const glm::ivec2 low(atlas_.charts[chart].originTexel());
        const glm::ivec2 high = low + glm::ivec2(atlas_.charts[chart].sizeTexels()) - 1;
        const int reach = int(radius);
        const glm::ivec2 from = glm::max(center - reach, low) / int(kLevelSteps[0]);
        const glm::ivec2 to = glm::min(center + reach, high) / int(kLevelSteps[0]);
        const auto visit = [&](size_t level, uint32_t node, bool split) {
            const uint32_t other = levels_[level].texel[node];
            const glm::vec2 offset = glm::vec2(placeOf(other) - center) / radius;
            const float fall = 1.0f - glm::dot(offset, offset);
            if (fall <= 0.0f) return;
            const float cosine = glm::dot(points_.normal[texel], points_.normal[other]);
            const float alike = (cosine - kLeastNormalCosine) / (1.0f - kLeastNormalCosine);
            if (alike > 0.0f) add(level, node, split, fall * fall * alike, offset);
        };
        for (int y = from.y; y <= to.y; ++y)
            for (int x = from.x; x <= to.x; ++x)
                if (atlas_.chartAt(glm::uvec2(x, y) * kLevelSteps[0]) == chart) descend(0, {x, y}, visit);
    }

    template <typename Visit>
    bool descend(size_t level, glm::uvec2 group, const Visit& visit) const {
        const IrradianceLevel& here = levels_[level];
        const uint32_t node = here.node[size_t(group.y) * here.size.x + group.x];
        if (node == kNoNode) return false;
        bool split = false;
        if (level + 1 < levels_.size())
            for (uint32_t i = 0; i < 4; ++i)
                split |= descend(level + 1, 2u * group + glm::uvec2(i & 1, i >> 1), visit);
        visit(level, node, split);
        return true;
    }

    const std::vector<IrradianceLevel>& levels_;
    const Atlas& atlas_;
    const TexelPoints& points_;
    const ChartSet& charts_;
    std::vector<std::vector<glm::vec3>> values_;  // [level][node]
    std::vector<std::vector<float>> noise_;       // [level][node], variance of the luminance
    std::vector<std::vector<glm::vec3>> smooth_;  // [level][node]
};

}  // namespace

IrradianceLevel makeLevel(const Atlas& atlas, const std::vector<uint8_t>& irradianceTexels, uint32_t step,
                          const std::function<bool(glm::uvec2 group)>& wanted) {
    IrradianceLevel level;
    level.step = step;
    level.size = atlas.sizeTexels / step;
    level.node.assign(size_t(level.size.x) * level.size.y, kNoNode);
    for (uint32_t y = 0; y < level.size.y; ++y) {
        for (uint32_t x = 0; x < level.size.x; ++x) {
            uint32_t best = kNoNode;
            float bestCost = 1e30f;
            for (uint32_t i = 0; i < step * step; ++i) {
                const glm::uvec2 within(i % step, i / step);
                const glm::uvec2 texel = glm::uvec2(x, y) * step + within;
                const size_t index = size_t(texel.y) * atlas.sizeTexels.x + texel.x;
                if (!irradianceTexels[index]) continue;
                const glm::vec2 off = glm::vec2(within) - 0.5f * float(step - 1);
                const float cost = glm::dot(off, off);
                if (cost >= bestCost) continue;
                bestCost = cost;
                best = uint32_t(index);
            }
            if (best == kNoNode || !wanted({x, y})) continue;
            level.node[size_t(y) * level.size.x + x] = uint32_t(level.texel.size());
            level.texel.push_back(best);
        }
    }
    return level;
}

IrradianceMap interpolateLevels(const std::vector<IrradianceLevel>& levels, const Atlas& atlas,
                                const TexelPoints& points, const ChartSet& charts) {
    const Interpolator interpolator(levels, atlas, points, charts);
    IrradianceMap map(atlas.texelCount(), glm::vec3(0));
    std::vector<uint8_t> known(map.size(), 0);
    SilentProgress silent;
    parallelRanges(map.size(), 4096, silent, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) {
            if (!hasChart(charts, atlas.chartAt({i % atlas.sizeTexels.x, i / atlas.sizeTexels.x}))) {
                known[i] = 1;  // nothing to fill
                continue;
            }
            if (!points.valid(i) || !interpolator.hasNode(uint32_t(i))) continue;
            map[i] = interpolator.at(uint32_t(i));
            known[i] = 1;
        }
    });
    fillWithinCharts(map, known, atlas);
    return map;
}

}  // namespace phat
