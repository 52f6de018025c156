#pragma once
// The whole bake, as the paper's section 5 reads.

#include "core/atlas/atlas.h"
#include "core/bake/bake_settings.h"
#include "core/bake/journal.h"
#include "core/base/progress.h"
#include "core/phatexel/phatexture.h"
#include "core/scene/rays.h"

namespace phat {

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

/// Throws Interrupted when `progress` requests it, std::invalid_argument for splats without photon
/// directions.
Bake bake(const RayScene& rays, const BakeSettings& settings, Progress& progress,
          BakeJournal* journal = nullptr);
inline Bake bake(const Scene& scene, const BakeSettings& settings, Progress& progress,
                 BakeJournal* journal = nullptr) {
    return bake(RayScene(scene), settings, progress, journal);
}

/// Upper estimate of the memory that bake() needs, in bytes, before anything is allocated.
uint64_t estimateBakeMemory(const Scene& scene, const BakeSettings& settings);

}  // namespace phat
