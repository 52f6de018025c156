#pragma once
// Where each PHATexel looks. source: Hensley et al. 2003, sections 4.1 and 5.1.1; guided and the layout:
// ours.

#include <span>
#include <vector>

#include "core/atlas/atlas.h"
#include "core/base/progress.h"
#include "core/phatexel/phatexture.h"
#include "core/transport/photon_map.h"

namespace phat {

/// How PHATexel directions are chosen.
enum class Directions : uint8_t { guided, photons, nearestPhoton, uniform, cosine };
/// Whether a direction is a photon's, whose light RadianceSource::splat needs.
inline bool choosesPhotons(Directions directions) {
    return directions == Directions::photons || directions == Directions::nearestPhoton;
}

/// Point of the unit square of the PHATexel at `texelInBlock` (0..31 each): a permutation of the block's
/// 32x32 cells in which every aligned 2^k x 2^k group of texels has exactly one sample in each of the 2^k x
/// 2^k coarse cells. `jitter` in [0,1)^2 moves it within its cell; `scramble` chooses among 1024
/// permutations. source: the bit-reversed Morton order of Ahmed and Wonka 2020, "Screen-Space Blue-Noise
/// Diffusion of Monte Carlo Sampling Error via Hierarchical Ordering of Pixels".
glm::vec2 stratifiedSquare(glm::uvec2 texelInBlock, uint32_t scramble, glm::vec2 jitter);

/// Which photons a guide or a choice of direction looks at.
using PhotonFilter = bool (*)(const Photon&);
/// Light after at least one reflection: first hits are direct light (section 5.2).
bool isIndirectPhoton(const Photon& photon);
/// Light straight from an emissive surface or the environment.
bool isAreaPhoton(const Photon& photon);

/// The texels of an atlas and the frames of its blocks, as blockFrames makes them.
struct BlockGeometry {
    const Atlas& atlas;
    const TexelPoints& points;
    const std::vector<Frame>& frames;  // [block]
};

/// One guide a block: the density of incident radiance (flux / cos) of the photons around the block, 3x3
/// blurred, mixed with the uniform density. Proportional to L, not L cos: a GGX integrand has no cosine left.
std::vector<Guide> buildGuides(const BlockGeometry& blocks, const PhotonSet& photons, PhotonFilter keep,
                               Progress& progress);

/// The guide of one block. `bounds`: of its valid texels; empty: uniform. `unitMeters`: Atlas::unitMeters.
/// `near` is scratch.
Guide buildGuide(const Bounds& bounds, const Frame& frame, float unitMeters,
                 std::span<const PhotonSet> photons, PhotonFilter keep,
                 std::vector<PhotonIndex::Neighbor>& near);

/// Bounds of the block's valid texels.
Bounds blockBounds(const Atlas& atlas, const TexelPoints& points, const BlockRect& rect);

/// The direction of a PHATexel and its density, before its ray is traced.
struct TexelDirection {
    glm::vec3 directionBlock{0};
    float pdf = 0;               // 1/sr; 0: nothing was chosen
    glm::vec3 splatRadiance{0};  // W/(m2 sr), only with DirectionSettings::splatsRadiance
};

/// A direction for every valid texel, with its density. Directions are exactly
/// those that packPhatexel can hold, so that the ray traced and the direction stored are one.
struct ChosenDirections {
    std::vector<glm::vec3> directionBlock;  // [y][x]; zero where nothing was chosen
    std::vector<float> pdf;                 // [y][x], 1/sr
    std::vector<glm::vec3> splatRadiance;   // [y][x], only with DirectionSettings::splatsRadiance
    std::vector<uint16_t> scrambles;        // [block], not of photon strategies: see PhatexelLayer

    TexelDirection at(size_t texel) const {
        return {directionBlock[texel], pdf[texel],
                splatRadiance.empty() ? glm::vec3(0) : splatRadiance[texel]};
    }
};

struct DirectionSettings {
    Directions strategy = Directions::guided;
    DensityEstimate density;  // the photon strategies' neighbourhood
    uint64_t seed = 1;
    int layer = 0;
    bool splatsRadiance = false;  // the chosen photon's own light is the radiance
};

/// Which permutation a block's texels follow: see PhatexelLayer.
uint16_t scrambleOf(const DirectionSettings& settings, uint32_t block);

/// Of one texel, by the guide of its block.
TexelDirection chooseDirection(const Atlas& atlas, const Guide& guide, glm::uvec2 texel,
                               const DirectionSettings& settings);

/// A direction for every valid texel. `guides`: one a block, or a single one for all.
/// pre: not a photon strategy: see choosePhotonDirections.
ChosenDirections chooseGuidedDirections(const BlockGeometry& blocks, const std::vector<Guide>& guides,
                                        const DirectionSettings& settings, Progress& progress);

}  // namespace phat
