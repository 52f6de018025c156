#include "core/atlas/chart_fill.h"
#include "core/atlas/texel_neighbors.h"
#include "core/bake/irradiance.h"
#include "core/base/parallel.h"

namespace phat {
namespace {

constexpr int kReach = 3;
// Differences of this many standard errors still count as noise.
constexpr float kNoiseSigmas = 3.0f;
// Lower bound of the relative standard error: half a percent is invisible.
constexpr float kMinFilterRelativeError = 0.005f;
// Normals farther apart than this are different surfaces to the eye, even in one chart.
constexpr float kMinFilterNormalCosine = 0.9f;
// In rays: a texel of either pass.
constexpr uint64_t kFilterWork = 1;

/// Mean of the 3x3 texels around, and its variance: an outlier is told from an edge by its surroundings, and
/// a variance from a few rounds is too noisy to be used alone.
struct Guide3x3 {
    float luminance = 0;
    float variance = 0;
};

template <typename Visit>
void forNeighbors(const Atlas& atlas, const std::vector<uint8_t>& receives, glm::ivec2 texel, int reach,
                  const Visit& visit) {
    const uint32_t chart = atlas.chartAt(texel);
    const glm::ivec2 low = glm::max(texel - reach, glm::ivec2(0));
    const glm::ivec2 high = glm::min(texel + reach, glm::ivec2(atlas.sizeTexels) - 1);
    for (int y = low.y; y <= high.y; ++y) {
        for (int x = low.x; x <= high.x; ++x) {
            const size_t index = size_t(y) * atlas.sizeTexels.x + x;
            if (atlas.chartAt({x, y}) == chart && receives[index]) visit(glm::ivec2(x, y) - texel, index);
        }
    }
}

}  // namespace

std::vector<uint8_t> irradianceTexels(const Atlas& atlas, const TexelPoints& points) {
    std::vector<uint8_t> hasSurface(atlas.charts.size(), 0), receives(points.state.size(), 0);
    for (size_t i = 0; i < receives.size(); ++i)
        if (points.state[i] == TexelState::surface) hasSurface[atlas.chartAt(i)] = 1;
    for (size_t i = 0; i < receives.size(); ++i)
        receives[i] =
            points.valid(i) && (points.state[i] == TexelState::surface || !hasSurface[atlas.chartAt(i)]);
    return receives;
}

ResumableTask filterAreaIrradiance(const std::vector<IrradianceEstimate>& estimates, ReceiverTexels texels,
                                   const ChartSet& charts, IrradianceMap& filtered, uint64_t sliceWork) {
    const Atlas& atlas = texels.atlas;
    const TexelPoints& points = texels.points;
    const std::vector<uint8_t>& receives = texels.receives;
    const size_t width = atlas.sizeTexels.x;
    filtered.assign(estimates.size(), glm::vec3(0));
    std::vector<Guide3x3> guide(estimates.size());
    std::vector<uint8_t> known(estimates.size(), 0);
    const auto isOther = [&](size_t i) { return !hasChart(charts, atlas.chartAt(i)); };
    SilentProgress silent;
    const size_t most = itemsPerSlice(sliceWork, kFilterWork);
    const auto forValid = [&](size_t first, size_t last, const auto& body) {
        parallelRanges(last - first, 8192, silent, [&](size_t begin, size_t end) {
            for (size_t i = first + begin; i < first + end; ++i)
                if (receives[i] && !isOther(i)) body(i, glm::ivec2(i % width, i / width));
        });
    };
    const auto findGuide = [&](size_t i, glm::ivec2 texel) {
        float sum = 0, variance = 0, count = 0;
        forNeighbors(atlas, receives, texel, 1, [&](glm::ivec2, size_t j) {
            sum += luminance(estimates[j].value);
            variance += estimates[j].variance;
            count += 1;
        });
        guide[i].luminance = sum / count;
        guide[i].variance = variance / square(count) + square(kMinFilterRelativeError * guide[i].luminance);
    };
    const auto filter = [&](size_t i, glm::ivec2 texel) {
        glm::vec3 sum(0);
        float weights = 0;
        const TexelPlane plane(atlas, points, i);
        forNeighbors(atlas, receives, texel, kReach, [&](glm::ivec2 offset, size_t j) {
            if (glm::dot(points.normal[i], points.normal[j]) < kMinFilterNormalCosine) return;
            if (!plane.has(j, offset)) return;
            const float difference = guide[i].luminance - guide[j].luminance;
            const float noise = square(kNoiseSigmas) * (guide[i].variance + guide[j].variance);
            const float tent = (kReach + 1 - std::abs(offset.x)) * (kReach + 1 - std::abs(offset.y));
            const float weight =
                tent * (noise > 0.0f ? std::exp(-square(difference) / noise) : float(i == j));
            sum += weight * estimates[j].value;
            weights += weight;
        });
        filtered[i] = sum / weights;
        known[i] = 1;
    };
    for (const bool filters : {false, true})
        for (size_t begin = 0, end = 0; begin < estimates.size(); begin = end) {
            end = begin + std::min(most, estimates.size() - begin);
            if (filters)
                forValid(begin, end, filter);
            else
                forValid(begin, end, findGuide);
            co_yield (kFilterWork * (end - begin));
        }
    for (size_t i = 0; i < known.size() && !charts.empty(); ++i)
        if (isOther(i)) known[i] = 1;  // nothing to fill
    fillWithinCharts(filtered, known, atlas, points);
}

}  // namespace phat
