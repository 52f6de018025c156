#include "core/irradiance.h"

#include "core/chart_fill.h"
#include "core/parallel.h"

namespace phat {
namespace {

// The widest neighbourhood, texels: a block, some 3000 samples.
constexpr int kMaxRadius = 32;
// The narrowest: some fifty samples, below which noise is worse than blur.
constexpr float kMinRadius = 4.0f;
// First look, to learn how far away the surroundings are.
constexpr int kProbeRadius = 6;
// Samples are reused over at most this share of the distance to what they saw (design study).
constexpr float kRadiusOverDistance = 0.5f;
// The Jacobian lacks the cosine at the far end, which is not stored; bounding it bounds that error.
constexpr float kMaxJacobian = 4.0f;
// Irradiance is computed on a grid of every fourth texel, and of every second where the neighbourhood is
// narrower than kFineRadius; between them it has no detail and is interpolated.
constexpr uint32_t kFineStep = 2;
constexpr uint32_t kCoarse = 2;  // coarse steps in fine ones
constexpr float kFineRadius = 16.0f;

/// A PHATexel as this filter reads it.
struct Sample {
    glm::vec3 hit{0};       // world; a direction when far
    float distance = 0;     // 0: invalid
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
            const bool far = phatexel.distance >= kFarDistance;
            samples[texel] = {far ? direction : points.position[texel] + phatexel.distance * direction,
                              phatexel.distance, phatexel.radiance, 1.0f / phatexel.pdf};
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

Reconnected reconnect(const Sample& sample, glm::vec3 position) {
    if (sample.distance >= kFarDistance) return {sample.hit, kFarDistance, 1.0f};
    const glm::vec3 to = sample.hit - position;
    const float distance2 = std::max(glm::dot(to, to), 1e-12f);
    const float distance = std::sqrt(distance2);
    const float jacobian = std::clamp(square(sample.distance) / distance2, 1.0f / kMaxJacobian, kMaxJacobian);
    return {to / distance, distance, jacobian};
}

struct Estimate {
    glm::vec3 light{0};
    float weight = 0;
    float radius = 0;  // texels
};

class Filter {
  public:
    Filter(const Phatexture& phatexture, const Atlas& atlas, const TexelPoints& points)
        : atlas_(atlas), points_(points) {
        const std::vector<Frame> frames = blockFrames(atlas, points);
        for (const PhatexelLayer& layer : phatexture.indirect)
            layers_.push_back(decodeLayer(layer, phatexture.indirectGuides, atlas, points, frames));
    }

    /// Irradiance at a texel with valid samples around it; weight 0 otherwise.
    Estimate at(glm::uvec2 texel) const {
        const size_t index = size_t(texel.y) * atlas_.sizeTexels.x + texel.x;
        if (points_.state[index] == TexelState::unused) return {};
        const glm::vec3 position = points_.position[index];
        const glm::vec3 normal = points_.normal[index];
        const float radius = radiusAt(texel, position, normal);

        Estimate sum{.radius = radius};
        forNeighbors(texel, radius, [&](const Sample& sample, float cone) {
            const Reconnected seen = reconnect(sample, position);
            const float cosine = glm::dot(seen.direction, normal);
            if (cosine <= 0.0f) return;
            const float weight = cone * cosine * seen.jacobian * sample.inversePdf;
            sum.light += weight * sample.radiance;
            sum.weight += weight;
        });
        return sum;
    }

  private:
    template <typename Visit>
    void forNeighbors(glm::uvec2 texel, float radius, const Visit& visit) const {
        const Chart& chart = atlas_.charts[atlas_.chartAt(texel)];
        const uint32_t chartIndex = atlas_.chartAt(texel);
        const glm::ivec2 low(chart.originTexel()), high = low + glm::ivec2(chart.sizeTexels()) - 1;
        const int reach = int(radius);
        const glm::ivec2 from = glm::max(glm::ivec2(texel) - reach, low);
        const glm::ivec2 to = glm::min(glm::ivec2(texel) + reach, high);
        for (int y = from.y; y <= to.y; ++y) {
            for (int x = from.x; x <= to.x; ++x) {
                const float distance = glm::length(glm::vec2(x, y) - glm::vec2(texel));
                const float cone = 1.0f - distance / (radius + 1.0f);
                if (cone <= 0.0f) continue;
                if (atlas_.chartAt({x, y}) != chartIndex) continue;
                for (const std::vector<Sample>& layer : layers_) {
                    const Sample& sample = layer[size_t(y) * atlas_.sizeTexels.x + x];
                    if (sample.distance > 0.0f) visit(sample, cone);
                }
            }
        }
    }

    // Half the harmonic mean distance of what the cosine lobe sees.
    float radiusAt(glm::uvec2 texel, glm::vec3 position, glm::vec3 normal) const {
        float weight = 0, nearness = 0;
        forNeighbors(texel, kProbeRadius, [&](const Sample& sample, float) {
            const Reconnected seen = reconnect(sample, position);
            const float cosine = glm::dot(seen.direction, normal);
            if (cosine <= 0.0f) return;
            weight += cosine * sample.inversePdf;
            nearness += cosine * sample.inversePdf / seen.distance;
        });
        if (nearness <= 0.0f) return kMaxRadius;
        const float radius = kRadiusOverDistance * weight / nearness / atlas_.texelSizeMeters;
        return std::clamp(radius, kMinRadius, float(kMaxRadius));
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
    std::vector<float> radius;

    size_t index(glm::ivec2 p) const { return size_t(p.y) * size.x + p.x; }
};

void evaluate(Grid& grid, const Filter& filter, glm::uvec2 p) {
    const Estimate estimate = filter.at(kFineStep * p);
    grid.radius[grid.index(p)] = estimate.radius;
    if (estimate.weight <= 0.0f) return;
    grid.value[grid.index(p)] = kPi * estimate.light / estimate.weight;
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
    grid.size = atlas.sizeTexels / kFineStep;
    const size_t count = size_t(grid.size.x) * grid.size.y;
    grid.value.assign(count, glm::vec3(0));
    grid.known.assign(count, 0);
    grid.radius.assign(count, 0.0f);
    for (const bool coarse : {true, false}) {
        parallelRanges(count, 512, progress, [&](size_t begin, size_t end) {
            for (size_t i = begin; i < end; ++i) {
                const glm::uvec2 p(i % grid.size.x, i / grid.size.x);
                const bool onCoarse = p % kCoarse == glm::uvec2(0);
                if (onCoarse != coarse || atlas.chartAt(kFineStep * p) == kNoChart) continue;
                if (coarse || !interpolateCoarse(grid, atlas, p)) evaluate(grid, filter, p);
            }
        });
    }
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
