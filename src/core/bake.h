#pragma once
// The whole bake, as the paper's section 5 reads.

#include <string>

#include "core/atlas.h"
#include "core/phatexture.h"
#include "core/photon_map.h"
#include "core/progress.h"
#include "core/scene.h"

namespace phat {

/// How PHATexel directions are chosen.
enum class Directions : uint8_t { guided, photons, nearestPhoton, uniform, cosine };
/// Where the radiance of a PHATexel comes from.
enum class RadianceSource : uint8_t {
    texels,   // irradiance of the texels that the ray meets; glossy reflections on the way are followed
    path,     // paths from there, unbiased
    photons,  // the photons there: the paper's exact-solution analogue
    splat,    // the chosen photon itself: the paper's approximate analogue
};

/// Whether a direction is a photon's, whose light RadianceSource::splat needs.
inline bool choosesPhotons(Directions directions) {
    return directions == Directions::photons || directions == Directions::nearestPhoton;
}

struct BakeSettings {
    AtlasSettings atlas;
    PhotonSettings photons;
    DensityEstimate density;  // for RadianceSource::photons
    Directions directions = Directions::guided;
    RadianceSource radiance = RadianceSource::texels;
    int layers = 1;            // PHATexels per texel
    int pathsPerPhatexel = 8;  // RadianceSource::path, and texels on glossy surfaces
    int maxBounces = 12;
    int irradianceSamples = 16;  // shadow rays a texel for area lights' diffuse part; four times in penumbrae
    uint64_t seed = 1;
};

struct BakeStats {
    AtlasStats atlas;
    PhotonStats photons;
    uint64_t texels = 0;  // in the atlas
    uint64_t validPhatexels = 0;
    uint64_t rays = 0;  // traced after the photons
    double seconds = 0;
};

struct Bake {
    Atlas atlas;
    TexelPoints points;
    Phatexture phatexture;
    BakeStats stats;
};

/// Finished parts of the slow stage, so that an interrupted bake goes on where it was. Implemented by io.
class BakeJournal {
  public:
    virtual ~BakeJournal() = default;
    /// Bytes stored under `key` by an earlier run, empty if there are none.
    virtual std::vector<uint8_t> load(uint64_t key) = 0;
    /// Called from any thread; must be durable when it returns.
    virtual void store(uint64_t key, const std::vector<uint8_t>& bytes) = 0;
};

/// Throws Interrupted when `progress` asks, std::invalid_argument for splats without photon directions.
Bake bake(const Scene& scene, const BakeSettings& settings, Progress& progress,
          BakeJournal* journal = nullptr);

/// Upper estimate of the memory that bake() needs, in bytes, before anything is allocated.
uint64_t estimateBakeMemory(const Scene& scene, const BakeSettings& settings);

}  // namespace phat
