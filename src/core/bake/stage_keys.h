#pragma once
// Hashes of all that stages of a bake are computed from.
//
// A stage whose inputs are those of an earlier bake has the same result, bit by bit, and need not be computed
// again. What is hashed is rather too much than too little: a hash that differs costs time, one that should
// differ costs the right result.

#include <cstdint>

#include "core/atlas/atlas.h"
#include "core/bake/bake_settings.h"
#include "core/transport/photon_map.h"

namespace phat {

/// Of a bake; 0: not known, which is the same as nothing.
struct StageKeys {
    uint64_t all = 0;       // scene and settings: of everything
    uint64_t geometry = 0;  // surfaces, what light passes through, the atlas: occluded texels, distances
    uint64_t areaIrradiance = 0;  // the same, what shines
    uint64_t areaLight = 0;       // the same, the photons straight from there: guides and PHATexels

    bool operator==(const StageKeys&) const = default;
};

/// The keys of a scene, whose vertices and pictures are read once for all of them. The scene outlives it.
class SceneKeys {
  public:
    explicit SceneKeys(const Scene& scene);

    uint64_t ofAll(const BakeSettings& settings) const;
    uint64_t ofGeometry(const Atlas& atlas) const;
    /// `geometry`: the key of it.
    uint64_t ofAreaIrradiance(uint64_t geometry, const BakeSettings& settings) const;

  private:
    // By what materials may do to the light that a stage looks at.
    struct Materials {
        uint64_t all = 0, emission = 0, opacity = 0;
    };

    const Scene& scene_;
    uint64_t surfaces_;
    Materials materials_;
};

/// `areaIrradiance`: the key of it.
uint64_t keyOfAreaLight(uint64_t areaIrradiance, const PhotonMap& photons, const BakeSettings& settings);

/// Whether a key says that results are the same.
inline bool sameKey(uint64_t a, uint64_t b) {
    return a == b && a != 0;
}

}  // namespace phat
