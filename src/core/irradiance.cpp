#include "core/irradiance.h"

#include "core/chart_fill.h"
#include "core/parallel.h"

namespace phat {
namespace {

// Radius of the neighbourhood, texels: at most a block, some 3000 samples; at least so many that noise is not
// worse than blur. In between it is the clearance: half the harmonic mean distance of what a texel sees.
constexpr float kMaxRadius = 32.0f;
constexpr float kMinRadius = 12.0f;
// The clearance is measured over this radius, texels.
constexpr float kProbeRadius = 6.0f;
// A sample's origin is moved toward the texel by at most this share of the sample's distance. The Jacobian of
// the move lacks the cosine at the far end, which is not stored: in corners, where samples are as far from the
// texel as from what they hit, moving them all the way misweighs them by up to ten times.
constexpr float kMaxMoveOverDistance = 0.25f;
// Irradiance is computed on a grid of every fourth texel, and of every second where the radius is less than
// kFineRadius; between them it has no detail and is interpolated.
constexpr uint32_t kFineStep = 2;
constexpr uint32_t kCoarse = 2;  // coarse steps in fine ones
constexpr float kFineRadius = 16.0f;

/// A PHATexel as this filter reads it.
struct Sample {
    glm::vec3 direction{0};  // world
    float distance = 0;      // 0: below its texel's horizon
    glm::vec3 radiance{0};
    float inversePdf = 0;
};

std::vector<Sample> decodeLayer(const PhatexelLayer& layer, const std::vector<Guide>& guides, const Atlas& atlas,
                                const TexelPoints& points, const std::vector<Frame>& frames) {
    std::vector<Sample> samples(atlas.texelCount());
    SilentProgress silent;
    parallelRanges(atlas.texelCount(), 8192, silent, [&](size_t begin, size_t end) {
        for (size_t texel = begin; texel < end; ++texel) {
            if (!points.valid(texel)) continue;
            const glm::uvec2 xy(texel % atlas.sizeTexels.x, texel / atlas.sizeTexels.x);
            const Phatexel phatexel = phatexelAt(layer, guides, atlas, xy);
            if (!phatexel.valid || phatexel.pdf <= 0.0f) continue;
            const glm::vec3 direction = frames[atlas.blockAt(xy)].toWorld(phatexel.directionBlock);
            samples[texel] = {direction, phatexel.distance, phatexel.radiance, 1.0f / phatexel.pdf};
        }
    });
    return samples;
}

/// The sample as seen from another place.
struct Reconnected {
    glm::vec3 direction;
    float distance;
    float jacobian;
};

Reconnected reconnect(const Sample& sample, glm::vec3 from, glm::vec3 to) {
    if (sample.distance >= kFarDistance) return {sample.direction, kFarDistance, 1.0f};
    const glm::vec3 way = to - from;
    const float length = glm::length(way);
    const float most = kMaxMoveOverDistance * sample.distance;
    const glm::vec3 moved = length > most ? way * (most / length) : way;
    const glm::vec3 toHit = sample.distance * sample.direction - moved;
    const float distance = glm::length(toHit);
    return {toHit / distance, distance, square(sample.distance / distance)};
}

/// Irradiance from samples a L and a, a = cos J / p, whose mean is known to be pi. The control variate that the
/// samples themselves regress takes out what the two share: it is the ratio estimator where light is constant
/// (exact in a furnace) and the plain mean where p follows the light (whose a is noisy, but not a L).
/// source: control variates as in Owen 2013, "Monte Carlo theory, methods and examples", section 8.9.
class Regression {
  public:
    void add(float weight, float a, glm::vec3 radiance) {
        const glm::dvec3 light = double(a) * glm::dvec3(radiance);
        weights_ += weight;
        unit_ += double(weight) * a;
        unitSquared_ += double(weight) * a * a;
        light_ += double(weight) * light;
        product_ += double(weight) * a * light;
    }
    bool empty() const { return unit_ <= 0.0; }
    /// pre: not empty().
    glm::vec3 irradiance() const {
        const double unit = unit_ / weights_;
        const glm::dvec3 light = light_ / weights_;
        const double variance = unitSquared_ / weights_ - unit * unit;
        const glm::dvec3 covariance = product_ / weights_ - unit * light;
        if (variance <= 1e-6 * unit * unit) return glm::vec3(double(kPi) / unit * light);
        // Between the mean (0) and the ratio: outside, few samples pretend to more than they know.
        const glm::dvec3 slope = glm::clamp(covariance / variance, glm::dvec3(0), light / unit);
        return glm::vec3(glm::max(light - slope * (unit - double(kPi)), glm::dvec3(0)));
    }

  private:
    double weights_ = 0, unit_ = 0, unitSquared_ = 0;
    glm::dvec3 light_{0}, product_{0};
};

class Filter {
  public:
    Filter(const Phatexture& phatexture, const Atlas& atlas, const TexelPoints& points)
        : atlas_(atlas), points_(points) {
        const std::vector<Frame> frames = blockFrames(atlas, points);
        for (const PhatexelLayer& layer : phatexture.indirect)
            layers_.push_back(decodeLayer(layer, phatexture.indirectGuides, atlas, points, frames));
    }

    glm::uvec2 gridSize() const { return atlas_.sizeTexels / kFineStep; }
    bool valid(glm::uvec2 texel) const { return points_.valid(texelIndex(texel)); }

    /// Radius of a valid texel's neighbourhood, texels.
    float radiusAt(glm::uvec2 texel) const {
        float weight = 0, nearness = 0;
        forNeighbors(texel, kProbeRadius, [&](const Sample& sample, size_t index, float) {
            if (sample.distance <= 0.0f) return;
            const Reconnected seen = reconnect(sample, points_.position[index], positionAt(texel));
            const float cosine = glm::dot(seen.direction, normalAt(texel));
            if (cosine <= 0.0f) return;
            weight += cosine * sample.inversePdf;
            nearness += cosine * sample.inversePdf / seen.distance;
        });
        if (nearness <= 0.0f) return kMaxRadius;
        return std::clamp(0.5f * weight / nearness / atlas_.texelSizeMeters, kMinRadius, kMaxRadius);
    }

    Regression irradianceAt(glm::uvec2 texel, float radius) const {
        Regression sum;
        forNeighbors(texel, radius, [&](const Sample& sample, size_t index, float cone) {
            // A direction below the horizon was drawn like any other and brought nothing.
            if (sample.distance <= 0.0f) return sum.add(cone, 0.0f, glm::vec3(0));
            const Reconnected seen = reconnect(sample, points_.position[index], positionAt(texel));
            const float cosine = std::max(glm::dot(seen.direction, normalAt(texel)), 0.0f);
            sum.add(cone, cosine * seen.jacobian * sample.inversePdf, sample.radiance);
        });
        return sum;
    }

  private:
    size_t texelIndex(glm::uvec2 texel) const { return size_t(texel.y) * atlas_.sizeTexels.x + texel.x; }
    glm::vec3 positionAt(glm::uvec2 texel) const { return points_.position[texelIndex(texel)]; }
    glm::vec3 normalAt(glm::uvec2 texel) const { return points_.normal[texelIndex(texel)]; }

    // Visits the samples of the valid texels of the chart within a radius, with a weight that falls off linearly.
    template <typename Visit>
    void forNeighbors(glm::uvec2 texel, float radius, const Visit& visit) const {
        const uint32_t chartIndex = atlas_.chartAt(texel);
        const Chart& chart = atlas_.charts[chartIndex];
        const glm::ivec2 low(chart.originTexel()), high = low + glm::ivec2(chart.sizeTexels()) - 1;
        const int reach = int(radius);
        const glm::ivec2 from = glm::max(glm::ivec2(texel) - reach, low);
        const glm::ivec2 to = glm::min(glm::ivec2(texel) + reach, high);
        for (int y = from.y; y <= to.y; ++y) {
            for (int x = from.x; x <= to.x; ++x) {
                const float distance = glm::length(glm::vec2(x, y) - glm::vec2(texel));
                const float cone = 1.0f - distance / (radius + 1.0f);
                if (cone <= 0.0f || atlas_.chartAt({x, y}) != chartIndex) continue;
                const size_t index = texelIndex({x, y});
                if (!points_.valid(index)) continue;
                for (const std::vector<Sample>& layer : layers_) visit(layer[index], index, cone);
            }
        }
    }

    const Atlas& atlas_;
    const TexelPoints& points_;
    std::vector<std::vector<Sample>> layers_;
};

/// Values on the fine grid; (x, y) of the grid is texel kFineStep * (x, y).
struct Grid {
    glm::uvec2 size{0};
    std::vector<glm::vec3> value;
    std::vector<uint8_t> known;
    std::vector<float> radius;  // of the neighbourhood, texels

    size_t index(glm::ivec2 p) const { return size_t(p.y) * size.x + p.x; }
};

void evaluate(Grid& grid, const Filter& filter, glm::uvec2 p) {
    grid.radius[grid.index(p)] = filter.radiusAt(kFineStep * p);
    const Regression samples = filter.irradianceAt(kFineStep * p, grid.radius[grid.index(p)]);
    if (samples.empty()) return;
    grid.value[grid.index(p)] = samples.irradiance();
    grid.known[grid.index(p)] = 1;
}

/// Mean of the coarse points around p if they all are of its chart, known and wide; false otherwise.
bool interpolateCoarse(Grid& grid, const Atlas& atlas, glm::uvec2 p) {
    const uint32_t chart = atlas.chartAt(kFineStep * p);
    const glm::uvec2 low = p / kCoarse * kCoarse;
    const glm::uvec2 step = kCoarse * (p % kCoarse);  // 0 along an axis on which p is itself coarse
    glm::vec3 sum(0);
    for (uint32_t i = 0; i < 4; ++i) {
        const glm::uvec2 q = low + step * glm::uvec2(i & 1, i >> 1);
        if (q.x >= grid.size.x || q.y >= grid.size.y) return false;
        const size_t index = grid.index(q);
        if (atlas.chartAt(kFineStep * q) != chart || !grid.known[index] || grid.radius[index] < kFineRadius)
            return false;
        sum += 0.25f * grid.value[index];
    }
    grid.value[grid.index(p)] = sum;
    grid.known[grid.index(p)] = 1;
    return true;
}

Grid evaluateGrid(const Filter& filter, const Atlas& atlas, Progress& progress) {
    Grid grid;
    grid.size = filter.gridSize();
    const size_t count = size_t(grid.size.x) * grid.size.y;
    grid.value.assign(count, glm::vec3(0));
    grid.known.assign(count, 0);
    grid.radius.assign(count, 0.0f);
    const auto forValid = [&](const auto& body) {
        parallelRanges(count, 512, progress, [&](size_t begin, size_t end) {
            for (size_t i = begin; i < end; ++i) {
                const glm::uvec2 p(i % grid.size.x, i / grid.size.x);
                if (atlas.chartAt(kFineStep * p) != kNoChart && filter.valid(kFineStep * p)) body(p);
            }
        });
    };
    forValid([&](glm::uvec2 p) {
        if (p % kCoarse == glm::uvec2(0)) evaluate(grid, filter, p);
    });
    forValid([&](glm::uvec2 p) {
        if (p % kCoarse != glm::uvec2(0) && !interpolateCoarse(grid, atlas, p)) evaluate(grid, filter, p);
    });
    return grid;
}

IrradianceMap interpolate(const Grid& grid, const Atlas& atlas) {
    IrradianceMap map(atlas.texelCount(), glm::vec3(0));
    SilentProgress silent;
    parallelRanges(atlas.sizeTexels.y, 8, silent, [&](size_t begin, size_t end) {
        for (size_t y = begin; y < end; ++y) {
            for (uint32_t x = 0; x < atlas.sizeTexels.x; ++x) {
                const uint32_t chart = atlas.chartAt({x, y});
                if (chart == kNoChart) continue;
                const glm::ivec2 corner(x / kFineStep, y / kFineStep);
                const glm::vec2 t(float(x % kFineStep) / kFineStep, float(y % kFineStep) / kFineStep);
                glm::vec3 sum(0);
                float weights = 0;
                for (int i = 0; i < 4; ++i) {
                    const glm::ivec2 offset(i & 1, i >> 1);
                    const glm::ivec2 p = glm::min(corner + offset, glm::ivec2(grid.size) - 1);
                    if (atlas.chartAt(glm::uvec2(p) * kFineStep) != chart || !grid.known[grid.index(p)]) continue;
                    const glm::vec2 w = glm::mix(1.0f - t, t, glm::vec2(offset));
                    sum += w.x * w.y * grid.value[grid.index(p)];
                    weights += w.x * w.y;
                }
                if (weights > 0.0f) map[y * atlas.sizeTexels.x + x] = sum / weights;
            }
        }
    });
    return map;
}

}  // namespace

IrradianceMap filterIndirectIrradiance(const Phatexture& phatexture, const Atlas& atlas,
                                       const TexelPoints& points, Progress& progress) {
    const Filter filter(phatexture, atlas, points);
    Grid grid = evaluateGrid(filter, atlas, progress);
    fillWithinCharts(grid.value, grid.known, atlas, kFineStep);
    return interpolate(grid, atlas);
}

}  // namespace phat
