#include "core/lookup_tables.h"

#include <optional>

#include "core/parallel.h"
#include "core/random.h"

namespace phat {
namespace {

constexpr int kCellBits = 10;  // 32 x 32 cells a block

uint32_t cellOfSquare(glm::vec2 square) {
    const glm::uvec2 cell = glm::min(glm::uvec2(square * float(kBlockSize)), glm::uvec2(kBlockSize - 1));
    return morton(cell.x, cell.y);
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

}  // namespace

LookupTables buildLookupTables(const std::vector<PhatexelLayer>& layers, const std::vector<Guide>& guides,
                               const Atlas& atlas, const TexelPoints& points,
                               const std::vector<Frame>& frames, const std::vector<TilePatch>& patches,
                               const RayScene& rays, Progress& progress) {
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
    tables.probes = traceDistanceProbes(atlas, points, frames, patches, rays, progress);
    return tables;
}

}  // namespace phat
