#include "core/phatexel/directions.h"

#include "core/base/parallel.h"
#include "core/base/random.h"

namespace phat {
namespace {

// Guide photons come from this far around a block at least (design study: 25 cm for 12 cm blocks).
constexpr float kGuideRadiusMeters = 0.25f;
constexpr float kGuideRadiusOverBlock = 1.5f;
// Share of directions that ignore the photons, so that nothing unseen by them is missed for good.
constexpr float kUniformShare = 0.3f;
// With few photons their histogram is noise: a prior of so many uniform ones joins them.
constexpr float kPriorPhotons = 8;
// flux / cos of a grazing photon would outweigh the rest of the block.
constexpr float kLeastGuideCosine = 0.05f;
// Photons on surfaces facing elsewhere are not of this block.
constexpr float kLeastNormalCosine = 0.5f;

using Cells = std::array<float, kGuideCells>;

int cellOfDirection(glm::vec3 direction) {
    const glm::vec2 square = hemisphereToSquare(direction) * float(kGuideSize);
    const glm::ivec2 cell = glm::clamp(glm::ivec2(square), 0, kGuideSize - 1);
    return cell.y * kGuideSize + cell.x;
}

// The direction that the 8 bytes can hold, near enough to `direction` to keep clear of its histogram cell's
// border: the density is read back from the cell, and a neighbour's may be a hundred times less.
glm::vec3 storableDirection(glm::vec3 direction) {
    constexpr float kMargin = 0.01f;  // of a cell; twice what rounding moves
    const auto round = [](glm::vec3 d) { return unpackOctahedral24(packOctahedral24(d)); };
    const glm::vec2 exact = hemisphereToSquare(direction) * float(kGuideSize);
    const glm::vec2 cell = glm::min(glm::floor(exact), float(kGuideSize - 1));
    glm::vec3 rounded = round(direction);
    rounded.z = std::max(rounded.z, 0.0f);
    const glm::vec2 square = hemisphereToSquare(rounded) * float(kGuideSize);
    const glm::vec2 inside = glm::clamp(square, cell + kMargin, cell + 1.0f - kMargin);
    if (inside == square) return rounded;
    return round(squareToHemisphere(inside / float(kGuideSize)));
}

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

struct Candidates {
    std::vector<PhotonIndex::Neighbor> neighbors;
    std::vector<float> weights;
    std::vector<int> cells;
};

/// A photon and the cell density that stands for the choice.
struct Choice {
    int photon = -1;
    int cell = 0;
    float pdf = 0;
    glm::vec3 estimate{0};  // so that the mean of f * estimate over choices is the density estimate of f
};

Choice choosePhoton(const PhotonMap& map, const PhotonIndex& index, glm::vec3 position, const Frame& frame,
                    const DirectionSettings& settings, PhotonFilter keep, uint64_t stream,
                    Candidates& candidates) {
    Choice choice;
    index.nearest(position, settings.density.neighbors, settings.density.maxRadiusMeters,
                  candidates.neighbors);
    if (candidates.neighbors.empty()) return choice;
    const float radius = std::sqrt(candidates.neighbors.back().distanceSquared);
    const bool cone = settings.strategy == Directions::photons;

    candidates.weights.assign(candidates.neighbors.size(), 0.0f);
    candidates.cells.assign(candidates.neighbors.size(), 0);
    float sum = 0, least = std::numeric_limits<float>::infinity();
    size_t winner = candidates.neighbors.size();
    for (size_t i = 0; i < candidates.neighbors.size(); ++i) {
        const Photon& photon = map.photons[candidates.neighbors[i].photon];
        const glm::vec3 direction = frame.toLocal(photon.towardOrigin);
        if (!keep(photon) || direction.z <= 0.0f ||
            glm::dot(photon.normal, frame.normal) < kLeastNormalCosine)
            continue;
        const float distance = std::sqrt(candidates.neighbors[i].distanceSquared);
        const float weight = cone ? 1.0f - distance / std::max(radius, 1e-12f) : 1.0f;
        if (weight <= 0.0f) continue;
        candidates.weights[i] = weight;
        candidates.cells[i] = cellOfDirection(direction);
        sum += weight;
        // Weighted reservoir of one, as a race of exponential clocks: the outcome does not depend on the
        // order of the photons (Efraimidis and Spirakis 2006).
        const float u = Rng(hashOf(stream, candidates.neighbors[i].photon)).uniform();
        const float clock = cone ? -std::log(1.0f - u) / weight : distance;
        if (clock < least) {
            least = clock;
            winner = i;
        }
    }
    if (winner == candidates.neighbors.size()) return choice;

    choice.photon = int(candidates.neighbors[winner].photon);
    choice.cell = candidates.cells[winner];
    float cellWeight = 0;
    for (size_t i = 0; i < candidates.weights.size(); ++i)
        if (candidates.weights[i] > 0.0f && candidates.cells[i] == choice.cell)
            cellWeight += candidates.weights[i];
    choice.pdf = cellWeight / sum * float(kGuideCells) / (2.0f * kPi);
    // E[f Phi W / A] over choices with chance w / W is sum(w f Phi) / A: the cone-filtered estimate, whose
    // kernel has volume pi r^2 / 3 (a disc for equal weights).
    const float kernelArea = kPi * radius * radius / (cone ? 3.0f : 1.0f);
    choice.estimate = map.photons[choice.photon].fluxWatts * (sum / std::max(kernelArea, 1e-12f));
    return choice;
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

Bounds blockBounds(const Atlas& atlas, const TexelPoints& points, const BlockPlace& place) {
    Bounds bounds;
    for (uint32_t y = 0; y < place.size.y; ++y)
        for (uint32_t x = 0; x < place.size.x; ++x) {
            const size_t texel = size_t(place.origin.y + y) * atlas.sizeTexels.x + place.origin.x + x;
            if (points.valid(texel)) bounds.add(points.position[texel]);
        }
    return bounds;
}

Guide buildGuide(const Bounds& bounds, const Frame& frame, std::span<const PhotonSet> photonSets,
                 PhotonFilter keep, std::vector<PhotonIndex::Neighbor>& near) {
    if (bounds.empty()) return uniformGuide();
    const float radius = std::max(kGuideRadiusMeters, kGuideRadiusOverBlock * 0.5f * bounds.diagonal());
    Cells cells{};
    float count = 0, sum = 0;
    for (const PhotonSet& set : photonSets) {
        set.index.within(bounds.center(), radius, near);
        for (const PhotonIndex::Neighbor& neighbor : near) {
            const Photon& photon = set.photons.photons[neighbor.photon];
            if (!keep(photon) || glm::dot(photon.normal, frame.normal) < kLeastNormalCosine) continue;
            const glm::vec3 direction = frame.toLocal(photon.towardOrigin);
            if (direction.z <= 0.0f) continue;
            const float weight = luminance(photon.fluxWatts) / std::max(direction.z, kLeastGuideCosine);
            cells[cellOfDirection(direction)] += weight;
            sum += weight;
            count += 1;
        }
    }
    if (sum <= 0.0f) return uniformGuide();
    const float trust = count / (count + kPriorPhotons);
    return makeGuide(blur3x3(cells), 1.0f - (1.0f - kUniformShare) * trust);
}

std::vector<Guide> buildGuides(const Atlas& atlas, const TexelPoints& points,
                               const std::vector<Frame>& frames, const PhotonMap& photons,
                               const PhotonIndex& index, PhotonFilter keep, Progress& progress) {
    const std::vector<BlockPlace> places = blockPlaces(atlas);
    const PhotonSet all{photons, index};
    std::vector<Guide> guides(atlas.blockCount);
    parallelRanges(atlas.blockCount, 16, progress, [&](size_t begin, size_t end) {
        std::vector<PhotonIndex::Neighbor> near;
        for (size_t block = begin; block < end; ++block)
            guides[block] = buildGuide(blockBounds(atlas, points, places[block]), frames[block],
                                       std::span(&all, 1), keep, near);
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

ChosenDirections chooseDirections(const Atlas& atlas, const TexelPoints& points,
                                  const std::vector<Frame>& frames, const std::vector<Guide>& guides,
                                  const PhotonMap& photons, const PhotonIndex& index, PhotonFilter keep,
                                  const DirectionSettings& settings, Progress& progress) {
    const bool fromPhotons = choosesPhotons(settings.strategy);
    ChosenDirections chosen;
    chosen.directionBlock.assign(atlas.texelCount(), glm::vec3(0));
    chosen.pdf.assign(atlas.texelCount(), 0.0f);
    if (fromPhotons) chosen.splatRadiance.assign(atlas.texelCount(), glm::vec3(0));
    for (uint32_t block = 0; !fromPhotons && block < atlas.blockCount; ++block)
        chosen.scrambles.push_back(scrambleOf(settings, block));

    parallelRanges(atlas.texelCount(), 4096, progress, [&](size_t begin, size_t end) {
        Candidates candidates;
        for (size_t texel = begin; texel < end; ++texel) {
            if (!points.valid(texel)) continue;
            const glm::uvec2 xy(texel % atlas.sizeTexels.x, texel / atlas.sizeTexels.x);
            const uint32_t block = atlas.blockAt(xy);
            if (!fromPhotons) {
                const Guide& guide = guides.size() == 1 ? guides[0] : guides[block];
                const TexelDirection direction = chooseDirection(atlas, guide, xy, settings);
                chosen.directionBlock[texel] = direction.directionBlock;
                chosen.pdf[texel] = direction.pdf;
                continue;
            }
            const uint64_t stream = hashOf(settings.seed, uint64_t(settings.layer), texel);
            const glm::vec2 jitter = Rng(stream).uniform2();
            const Choice choice = choosePhoton(photons, index, points.position[texel], frames[block],
                                               settings, keep, stream, candidates);
            if (choice.photon < 0) continue;
            const glm::vec2 cell(choice.cell % kGuideSize, choice.cell / kGuideSize);
            const glm::vec3 direction =
                storableDirection(squareToHemisphere((cell + jitter) / float(kGuideSize)));
            chosen.directionBlock[texel] = direction;
            chosen.pdf[texel] = choice.pdf;
            chosen.splatRadiance[texel] =
                choice.estimate * (choice.pdf / std::max(direction.z, kLeastGuideCosine));
        }
    });
    return chosen;
}

}  // namespace phat
