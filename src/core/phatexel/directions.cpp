#include "core/phatexel/directions.h"

#include <cassert>

#include "core/base/parallel.h"
#include "core/base/random.h"
#include "core/phatexel/direction_cells.h"

namespace phat {
namespace {

// Guide photons come from this far around a block at least, in units of length (design study: 25 cm for
// blocks of 12 cm).
constexpr float kGuideRadius = 0.25f;
constexpr float kGuideRadiusOverBlock = 1.5f;
// Share of directions that ignore the photons, so that nothing unseen by them is missed for good.
constexpr float kUniformFraction = 0.3f;
// A histogram of few photons is noise: a prior of so many uniform photons is added.
constexpr float kPriorPhotons = 8;
// flux / cos of a grazing photon would outweigh the rest of the block.
constexpr float kMinGuideCosine = 0.05f;

using Cells = std::array<float, kGuideCells>;

Cells blur3x3(const Cells& cells) {
    Cells blurred{};
    for (int y = 0; y < kGuideSize; ++y) {
        for (int x = 0; x < kGuideSize; ++x) {
            for (int dy = -1; dy <= 1; ++dy) {
                for (int dx = -1; dx <= 1; ++dx) {
                    const int sx = std::clamp(x + dx, 0, kGuideSize - 1);
                    const int sy = std::clamp(y + dy, 0, kGuideSize - 1);
                    blurred[y * kGuideSize + x] += cells[sy * kGuideSize + sx] / 9.0f;
                }
            }
        }
    }
    return blurred;
}

// Of 32 x 32 cells.
constexpr uint32_t kScrambleMask = kBlockSize * kBlockSize - 1;

}  // namespace

glm::vec2 stratifiedSquare(glm::uvec2 texelInBlock, uint32_t scramble, glm::vec2 jitter) {
    constexpr int kBits = 10;  // 32 x 32 cells
    const uint32_t cell =
        reverseBits(morton(texelInBlock.x, texelInBlock.y), kBits) ^ (scramble & kScrambleMask);
    return (glm::vec2(mortonDecode(cell)) + jitter) / float(kBlockSize);
}

bool isIndirectPhoton(const Photon& photon) {
    return !photon.firstHit;
}

bool isAreaPhoton(const Photon& photon) {
    return photon.firstHit && !photon.punctual;
}

Bounds blockBounds(const Atlas& atlas, const TexelPoints& points, const BlockRect& rect) {
    Bounds bounds;
    for (uint32_t y = 0; y < rect.size.y; ++y)
        for (uint32_t x = 0; x < rect.size.x; ++x) {
            const size_t texel = size_t(rect.origin.y + y) * atlas.sizeTexels.x + rect.origin.x + x;
            if (points.valid(texel)) bounds.add(points.position[texel]);
        }
    return bounds;
}

Guide buildGuide(const Bounds& bounds, const Frame& frame, float unitMeters,
                 std::span<const PhotonSet> photonSets, PhotonFilter keep,
                 std::vector<PhotonIndex::Neighbor>& near) {
    if (bounds.empty()) return uniformGuide();
    const float radius =
        std::max(kGuideRadius * unitMeters, kGuideRadiusOverBlock * 0.5f * bounds.diagonal());
    Cells cells{};
    float count = 0, sum = 0;
    for (const PhotonSet& set : photonSets) {
        set.index.within(bounds.center(), radius, near);
        for (const PhotonIndex::Neighbor& neighbor : near) {
            const Photon& photon = set.photons.photons[neighbor.photon];
            if (!keep(photon) || glm::dot(photon.normal, frame.normal) < kMinNormalCosine) continue;
            const glm::vec3 direction = frame.toLocal(photon.towardOrigin);
            if (direction.z <= 0.0f) continue;
            const float weight = luminance(photon.fluxWatts) / std::max(direction.z, kMinGuideCosine);
            cells[cellOfDirection(direction)] += weight;
            sum += weight;
            count += 1;
        }
    }
    if (sum <= 0.0f) return uniformGuide();
    const float trust = count / (count + kPriorPhotons);
    return makeGuide(blur3x3(cells), 1.0f - (1.0f - kUniformFraction) * trust);
}

std::vector<Guide> buildGuides(const BlockGeometry& blocks, const PhotonSet& photons, PhotonFilter keep,
                               Progress& progress) {
    const std::vector<BlockRect> rects = blockRects(blocks.atlas);
    std::vector<Guide> guides(blocks.atlas.blockCount);
    parallelRanges(blocks.atlas.blockCount, 16, progress, [&](size_t begin, size_t end) {
        std::vector<PhotonIndex::Neighbor> near;
        for (size_t block = begin; block < end; ++block)
            guides[block] =
                buildGuide(blockBounds(blocks.atlas, blocks.points, rects[block]), blocks.frames[block],
                           blocks.atlas.unitMeters, std::span(&photons, 1), keep, near);
    });
    return guides;
}

uint16_t scrambleOf(const DirectionSettings& settings, uint32_t block) {
    return uint16_t(hashOf(settings.seed, uint64_t(settings.layer) + 1, block) & kScrambleMask);
}

TexelDirection chooseDirection(const Atlas& atlas, const Guide& guide, glm::uvec2 texel,
                               const DirectionSettings& settings) {
    const size_t index = size_t(texel.y) * atlas.sizeTexels.x + texel.x;
    const glm::vec2 jitter = Rng(hashOf(settings.seed, uint64_t(settings.layer), index)).uniform2();
    const uint32_t scramble = scrambleOf(settings, atlas.blockAt(texel));
    const glm::uvec2 inBlock = (texel - atlas.charts[atlas.chartAt(texel)].originTexel()) % kBlockSize;
    const glm::vec3 direction =
        storableDirection(squareToGuide(guide, stratifiedSquare(inBlock, scramble, jitter)));
    return {direction, squareToGuidePdf(guide, direction), glm::vec3(0)};
}

ChosenDirections chooseGuidedDirections(const BlockGeometry& blocks, const std::vector<Guide>& guides,
                                        const DirectionSettings& settings, Progress& progress) {
    assert(!choosesPhotons(settings.strategy) && !guides.empty());
    const Atlas& atlas = blocks.atlas;
    ChosenDirections chosen;
    chosen.directionBlock.assign(atlas.texelCount(), glm::vec3(0));
    chosen.pdf.assign(atlas.texelCount(), 0.0f);
    for (uint32_t block = 0; block < atlas.blockCount; ++block)
        chosen.scrambles.push_back(scrambleOf(settings, block));

    parallelRanges(atlas.texelCount(), 4096, progress, [&](size_t begin, size_t end) {
        for (size_t texel = begin; texel < end; ++texel) {
            if (!blocks.points.valid(texel)) continue;
            const glm::uvec2 xy(texel % atlas.sizeTexels.x, texel / atlas.sizeTexels.x);
            const Guide& guide = guides.size() == 1 ? guides[0] : guides[atlas.blockAt(xy)];
            const TexelDirection direction = chooseDirection(atlas, guide, xy, settings);
            chosen.directionBlock[texel] = direction.directionBlock;
            chosen.pdf[texel] = direction.pdf;
        }
    });
    return chosen;
}

}  // namespace phat
