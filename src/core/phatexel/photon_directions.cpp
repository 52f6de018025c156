#include "core/phatexel/photon_directions.h"

#include <cassert>

#include "core/base/parallel.h"
#include "core/base/random.h"
#include "core/phatexel/direction_cells.h"

namespace phat {
namespace {

// Share of the directions of splats that look for cells without light. As of guides; untuned.
constexpr float kSplatUniformFraction = 0.3f;
// Photons at one point would have no area.
constexpr float kMinRimFraction = 4e-6f;  // of the largest radius
constexpr float kUniformPdf = 1.0f / (2.0f * kPi);

/// A photon that a texel may choose.
struct Candidate {
    const Photon* photon;
    uint32_t index;  // in the map
    int cell;
    float distance;
    float weight;
};

/// The photons around a texel.
struct Candidates {
    size_t texel = 0;
    std::vector<Candidate> photons;
    float weightSum = 0;
    float kernelVolume = 0;  // m2, of the filter: pi r^2 / 3 of a cone, pi r^2 of a disc

    bool empty() const { return weightSum <= 0.0f; }
    float cellWeight(int cell) const {
        float sum = 0;
        for (const Candidate& candidate : photons)
            if (candidate.cell == cell) sum += candidate.weight;
        return sum;
    }
};

/// The means over the texels of a block, [cell].
struct BlockHistogram {
    std::array<float, kGuideCells> pdf{};           // 1/sr, of choosing a photon
    std::array<glm::vec3, kGuideCells> radiance{};  // W/(m2 sr)
    float uniformFraction = 1;                      // of the texels' directions

    float mixedPdf(int cell) const {
        return (1.0f - kSplatUniformFraction) * pdf[size_t(cell)] + uniformFraction * kUniformPdf;
    }
};

class PhotonChooser {
  public:
    PhotonChooser(const BlockGeometry& blocks, const PhotonSet& photons, PhotonFilter keep,
                  const DirectionSettings& settings)
        : blocks_(blocks), photons_(photons), keep_(keep), settings_(settings) {}

    void chooseBlock(uint32_t block, const BlockRect& rect, ChosenDirections& chosen) {
        const Frame& frame = blocks_.frames[block];
        texels_.clear();
        for (uint32_t y = 0; y < rect.size.y; ++y)
            for (uint32_t x = 0; x < rect.size.x; ++x) {
                const size_t texel =
                    size_t(rect.origin.y + y) * blocks_.atlas.sizeTexels.x + rect.origin.x + x;
                if (blocks_.points.valid(texel)) texels_.push_back(candidatesOf(texel, frame));
            }
        const BlockHistogram histogram = settings_.splatsRadiance ? histogramOf(texels_) : BlockHistogram{};
        for (const Candidates& candidates : texels_) {
            const TexelDirection direction =
                settings_.splatsRadiance ? splat(candidates, histogram) : jitteredPhoton(candidates);
            chosen.directionBlock[candidates.texel] = direction.directionBlock;
            chosen.pdf[candidates.texel] = direction.pdf;
            if (settings_.splatsRadiance) chosen.splatRadiance[candidates.texel] = direction.splatRadiance;
        }
    }

  private:
    bool usesCone() const { return settings_.strategy == Directions::photons; }
    uint64_t streamOf(size_t texel) const { return hashOf(settings_.seed, uint64_t(settings_.layer), texel); }

    Candidates candidatesOf(size_t texel, const Frame& frame) {
        const std::vector<Photon>& map = photons_.photons.photons;
        const auto counts = [&](uint32_t i) {
            return keep_(map[i]) && glm::dot(map[i].normal, frame.normal) >= kMinNormalCosine &&
                   glm::dot(map[i].towardOrigin, frame.normal) > 0.0f;
        };
        // As in photonRadiance: the k-th only marks the rim; where fewer are found, the rim is the largest
        // radius.
        const uint32_t k = std::max(settings_.density.neighbors, 2u);
        const float maxRadius = settings_.density.maxRadiusMeters(photons_.photons);
        photons_.index.nearest(blocks_.points.position[texel], k, maxRadius, std::cref(counts), neighbors_);
        float radius = maxRadius;
        if (neighbors_.size() == k) {
            radius = std::max(std::sqrt(neighbors_.back().distanceSquared), kMinRimFraction * maxRadius);
            neighbors_.pop_back();
        }
        Candidates result{.texel = texel, .photons = {}};
        result.kernelVolume = kPi * radius * radius / (usesCone() ? 3.0f : 1.0f);
        for (const PhotonIndex::Neighbor& neighbor : neighbors_) {
            const Photon& photon = map[neighbor.photon];
            const float distance = std::sqrt(neighbor.distanceSquared);
            const float weight = usesCone() ? 1.0f - distance / radius : 1.0f;
            if (weight <= 0.0f) continue;
            result.photons.push_back({&photon, neighbor.photon,
                                      cellOfDirection(frame.toLocal(photon.towardOrigin)), distance, weight});
            result.weightSum += weight;
        }
        return result;
    }

    static BlockHistogram histogramOf(const std::vector<Candidates>& texels) {
        BlockHistogram histogram;
        if (texels.empty()) return histogram;
        const float perTexel = 1.0f / float(texels.size());
        float withPhotons = 0;
        for (const Candidates& candidates : texels) {
            if (candidates.empty()) continue;
            withPhotons += perTexel;
            for (const Candidate& candidate : candidates.photons) {
                const size_t cell = size_t(candidate.cell);
                const float weight = candidate.weight * kCellsPerSteradian * perTexel;
                histogram.pdf[cell] += weight / candidates.weightSum;
                histogram.radiance[cell] += candidate.photon->fluxWatts *
                                            (weight / (candidates.kernelVolume * meanCosine(candidate.cell)));
            }
        }
        histogram.uniformFraction = 1.0f - (1.0f - kSplatUniformFraction) * withPhotons;
        return histogram;
    }

    /// Weighted reservoir of one as a race of exponential clocks: the outcome does not depend on the order of
    /// the photons (Efraimidis and Spirakis 2006). Without the cone the nearest photon wins.
    const Candidate& chosenPhoton(const Candidates& candidates) const {
        const uint64_t stream = streamOf(candidates.texel);
        const auto clock = [&](const Candidate& candidate) {
            if (!usesCone()) return candidate.distance;
            return -std::log(1.0f - Rng(hashOf(stream, candidate.index)).uniform()) / candidate.weight;
        };
        const Candidate* winner = nullptr;
        float least = std::numeric_limits<float>::infinity();
        for (const Candidate& candidate : candidates.photons)
            if (const float time = clock(candidate); !winner || time < least) {
                least = time;
                winner = &candidate;
            }
        return *winner;
    }

    TexelDirection jitteredPhoton(const Candidates& candidates) const {
        if (candidates.empty()) return {};
        const int cell = chosenPhoton(candidates).cell;
        const glm::vec2 inCell = Rng(streamOf(candidates.texel)).uniform2();
        return {storableDirection(directionInCell(cell, inCell)),
                candidates.cellWeight(cell) / candidates.weightSum * kCellsPerSteradian, glm::vec3(0)};
    }

    /// Summed over the block, f L / pdf of both kinds of directions is the integral of f times the
    /// histogram's radiance (balance heuristic): a photon is chosen with the chance weight / weightSum and
    /// stands for flux weight / volume.
    TexelDirection splat(const Candidates& candidates, const BlockHistogram& histogram) const {
        Rng rng(streamOf(candidates.texel));
        const glm::vec2 square = rng.uniform2();
        if (candidates.empty() || rng.uniform() < kSplatUniformFraction) {
            const glm::vec3 direction = storableDirection(squareToHemisphere(square));
            const int cell = cellOfDirection(direction);
            return {direction, histogram.mixedPdf(cell), histogram.radiance[size_t(cell)]};
        }
        const Candidate& winner = chosenPhoton(candidates);
        const float perFlux = candidates.weightSum * histogram.pdf[size_t(winner.cell)] /
                              (candidates.kernelVolume * meanCosine(winner.cell));
        return {storableDirection(directionInCell(winner.cell, square)), histogram.mixedPdf(winner.cell),
                winner.photon->fluxWatts * perFlux};
    }

    const BlockGeometry& blocks_;
    const PhotonSet photons_;
    const PhotonFilter keep_;
    const DirectionSettings& settings_;
    std::vector<PhotonIndex::Neighbor> neighbors_;
    std::vector<Candidates> texels_;
};

}  // namespace

ChosenDirections choosePhotonDirections(const BlockGeometry& blocks, const PhotonSet& photons,
                                        PhotonFilter keep, const DirectionSettings& settings,
                                        Progress& progress) {
    assert(choosesPhotons(settings.strategy));
    ChosenDirections chosen;
    chosen.directionBlock.assign(blocks.atlas.texelCount(), glm::vec3(0));
    chosen.pdf.assign(blocks.atlas.texelCount(), 0.0f);
    if (settings.splatsRadiance) chosen.splatRadiance.assign(blocks.atlas.texelCount(), glm::vec3(0));
    const std::vector<BlockRect> rects = blockRects(blocks.atlas);
    parallelRanges(rects.size(), 4, progress, [&](size_t begin, size_t end) {
        PhotonChooser chooser(blocks, photons, keep, settings);
        for (size_t block = begin; block < end; ++block)
            chooser.chooseBlock(uint32_t(block), rects[block], chosen);
    });
    return chosen;
}

}  // namespace phat
