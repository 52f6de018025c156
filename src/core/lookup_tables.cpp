#include "core/lookup_tables.h"

#include <optional>

#include "core/hemisphere_map.h"
#include "core/parallel.h"
#include "core/random.h"

namespace phat {
namespace {

constexpr int kCellBits = 10;  // 32 x 32 cells a block

// A probe hears the texels within this many texels of it (design study: 24 at a spacing of 8 to 12).
constexpr int kProbeReachTexels = 24;

uint32_t cellOfSquare(glm::vec2 square) {
    const glm::uvec2 cell = glm::min(glm::uvec2(square * float(kBlockSize)), glm::uvec2(kBlockSize - 1));
    return morton(cell.x, cell.y);
}

struct BlockPlace {
    glm::uvec2 origin;  // texel
    glm::uvec2 size;    // texels of the chart
    uint32_t chart;
};

std::vector<BlockPlace> blockPlaces(const Atlas& atlas) {
    std::vector<BlockPlace> places(atlas.blockCount);
    for (uint32_t c = 0; c < atlas.charts.size(); ++c) {
        const Chart& chart = atlas.charts[c];
        for (uint32_t y = 0; y < chart.blocksHigh(); ++y)
            for (uint32_t x = 0; x < chart.blocksWide(); ++x) {
                const glm::uvec2 offset = glm::uvec2(x, y) * kBlockSize;
                places[chart.firstBlock + y * chart.blocksWide() + x] = {
                    chart.originTexel() + offset,
                    glm::min(glm::uvec2(kBlockSize), chart.sizeTexels() - offset), c};
            }
    }
    return places;
}

// The permutation is not in the file: each texel's direction tells it, but for those that rounding moved to
// the next cell, so the block votes.
std::optional<uint16_t> voteScramble(const PhatexelLayer& layer, const Guide& guide, const Atlas& atlas,
                                     const BlockPlace& place) {
    std::array<uint16_t, 1u << kCellBits> votes{};
    uint32_t cast = 0;
    for (uint32_t y = 0; y < place.size.y; ++y) {
        for (uint32_t x = 0; x < place.size.x; ++x) {
            const size_t texel = size_t(place.origin.y + y) * atlas.sizeTexels.x + place.origin.x + x;
            const Phatexel phatexel = unpackPhatexel(layer.texels[texel]);
            if (!phatexel.valid) continue;
            const uint32_t cell = cellOfSquare(guideToSquare(guide, phatexel.directionBlock));
            ++votes[cell ^ reverseBits(morton(x, y), kCellBits)];
            ++cast;
        }
    }
    const auto winner = std::max_element(votes.begin(), votes.end());
    if (2 * *winner < cast) return std::nullopt;
    return uint16_t(winner - votes.begin());
}

Warp warpOf(const Guide& guide) {
    const auto code = [](double x) { return uint8_t(std::lround(255.0 * x)); };
    std::array<double, kGuideSize> rows{};
    double total = 0;
    for (int i = 0; i < kGuideCells; ++i) {
        rows[i / kGuideSize] += guide.weight[i];
        total += guide.weight[i];
    }
    Warp warp;
    double above = 0;
    for (int y = 0; y < kGuideSize; ++y) {
        double before = 0;
        for (int x = 0; x < kGuideSize; ++x) {
            const double weight = guide.weight[y * kGuideSize + x];
            warp[y * kGuideSize + x] = {code(before / rows[y]), code((before + weight) / rows[y]),
                                        code(above / total), code((above + rows[y]) / total)};
            before += weight;
        }
        above += rows[y];
    }
    return warp;
}

/// Where a PHATexel's light comes from; `toward` a direction when that is infinitely far.
struct HitPoint {
    glm::vec3 place{0};
    glm::vec3 toward{0};
    bool far = false;
    bool valid = false;
};

HitPoint hitPointOf(const PhatexelLayer& layer, const Atlas& atlas, const TexelPoints& points,
                    const std::vector<Frame>& frames, size_t texel) {
    HitPoint hit;
    const Phatexel phatexel = unpackPhatexel(layer.texels[texel]);
    if (!phatexel.valid) return hit;
    const glm::uvec2 xy(texel % atlas.sizeTexels.x, texel / atlas.sizeTexels.x);
    hit.toward = frames[atlas.blockAt(xy)].toWorld(phatexel.directionBlock);
    hit.far = phatexel.distance >= kFarDistance;
    hit.place = points.position[texel] + hit.toward * (hit.far ? 0.0f : phatexel.distance);
    hit.valid = true;
    return hit;
}

/// Weighted means of 1 / distance, halved in size until one cell is left.
using Sums = std::vector<glm::vec2>;  // sum w / d, sum w

// Cells without samples take their parent's mean (pull-push: Gortler et al. 1996, "The Lumigraph").
Sums fillHoles(const Sums& fine, int size) {
    if (size == 1) return fine;
    const int half = size / 2;
    Sums coarse(size_t(half) * half, glm::vec2(0));
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x) coarse[(y / 2) * half + x / 2] += fine[y * size + x];
    coarse = fillHoles(coarse, half);
    Sums filled = fine;
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x)
            if (filled[y * size + x].y <= 0.0f) filled[y * size + x] = coarse[(y / 2) * half + x / 2];
    return filled;
}

}  // namespace

LookupTables buildLookupTables(const std::vector<PhatexelLayer>& layers, const std::vector<Guide>& guides,
                               const Atlas& atlas, const TexelPoints& points,
                               const std::vector<Frame>& frames, Progress& progress) {
    LookupTables tables;
    if (layers.empty() || guides.empty()) return tables;
    const std::vector<BlockPlace> places = blockPlaces(atlas);
    for (const PhatexelLayer& layer : layers) {
        std::vector<uint16_t>& scrambles = tables.scrambles.emplace_back(atlas.blockCount);
        std::atomic<bool> invertible = layer.pdf.empty();
        parallelRanges(atlas.blockCount, 16, progress, [&](size_t begin, size_t end) {
            for (size_t b = begin; b < end; ++b) {
                const auto scramble =
                    voteScramble(layer, guides[guides.size() == 1 ? 0 : b], atlas, places[b]);
                if (!scramble) invertible = false;
                scrambles[b] = scramble.value_or(0);
            }
        });
        if (!invertible) return {};
    }
    for (const Guide& guide : guides) tables.warps.push_back(warpOf(guide));

    std::vector<HitPoint> hits(atlas.texelCount());
    parallelRanges(hits.size(), 4096, progress, [&](size_t begin, size_t end) {
        for (size_t texel = begin; texel < end; ++texel)
            hits[texel] = hitPointOf(layers[0], atlas, points, frames, texel);
    });

    tables.probes.resize(size_t(atlas.blockCount) * kProbesAlongBlock * kProbesAlongBlock);
    parallelRanges(tables.probes.size(), 16, progress, [&](size_t begin, size_t end) {
        for (size_t p = begin; p < end; ++p) {
            const size_t block = p / (kProbesAlongBlock * kProbesAlongBlock);
            const glm::uvec2 inBlock(p % kProbesAlongBlock, p / kProbesAlongBlock % kProbesAlongBlock);
            const BlockPlace& place = places[block];
            DistanceProbe& probe = tables.probes[p];
            probe.fill(uint8_t(packDistance(kFarDistance)));
            const glm::uvec2 corner = inBlock * kProbeTexels;
            if (corner.x >= place.size.x || corner.y >= place.size.y) continue;

            const Chart& chart = atlas.charts[place.chart];
            const glm::ivec2 low(chart.originTexel()), high = low + glm::ivec2(chart.sizeTexels());
            const glm::ivec2 center(place.origin + corner + kProbeTexels / 2);
            // The nearest texel with a place stands for the centre.
            glm::vec3 from(0);
            float nearest = 1e30f;
            for (uint32_t y = 0; y < kProbeTexels; ++y)
                for (uint32_t x = 0; x < kProbeTexels; ++x) {
                    const glm::ivec2 xy(place.origin + corner + glm::uvec2(x, y));
                    const size_t texel = size_t(xy.y) * atlas.sizeTexels.x + xy.x;
                    if (points.triangle[texel] == kNoTriangle) continue;
                    const float d = glm::length(glm::vec2(xy - center) + 0.5f);
                    if (d < nearest) {
                        nearest = d;
                        from = points.position[texel];
                    }
                }
            if (nearest > 1e29f) continue;
            Sums sums(kProbeSize * kProbeSize, glm::vec2(0));
            const glm::ivec2 first = glm::max(low, center - kProbeReachTexels);
            const glm::ivec2 last = glm::min(high, center + kProbeReachTexels);
            for (int y = first.y; y < last.y; ++y)
                for (int x = first.x; x < last.x; ++x) {
                    const HitPoint& hit = hits[size_t(y) * atlas.sizeTexels.x + x];
                    const float weight = 1.0f - glm::length(glm::vec2(x, y) + 0.5f - glm::vec2(center)) /
                                                    float(kProbeReachTexels);
                    if (!hit.valid || weight <= 0.0f) continue;
                    const glm::vec3 toward = hit.far ? hit.toward : hit.place - from;
                    const float distance = glm::length(toward);
                    const glm::vec3 local = frames[block].toLocal(toward / std::max(distance, 1e-6f));
                    if (local.z < 0.0f) continue;
                    const glm::ivec2 cell = glm::clamp(
                        glm::ivec2(hemisphereToSquare(local) * float(kProbeSize)), 0, kProbeSize - 1);
                    sums[cell.y * kProbeSize + cell.x] +=
                        weight * glm::vec2(hit.far ? 0.0f : 1.0f / std::max(distance, 1e-3f), 1.0f);
                }
            sums = fillHoles(sums, kProbeSize);
            for (size_t i = 0; i < probe.size(); ++i)
                if (sums[i].x > 0.0f) probe[i] = uint8_t(packDistance(sums[i].y / sums[i].x));
        }
    });
    return tables;
}

}  // namespace phat
