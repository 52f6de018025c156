#pragma once
// The whole bake, as the paper's section 5 reads.

#include <optional>

#include "core/atlas/atlas.h"
#include "core/atlas/earlier_charts.h"
#include "core/bake/bake_settings.h"
#include "core/bake/journal.h"
#include "core/bake/stage_keys.h"
#include "core/base/progress.h"
#include "core/phatexel/phatexture.h"
#include "core/scene/rays.h"

namespace phat {

/// What a bake has of an earlier one.
struct KeptParts {
    bool all = false;
    uint64_t phatexels = 0;           // with a value, of all layers
    std::vector<std::string> stages;  // that were not computed again
};

struct BakeStats {
    AtlasStats atlas;
    PhotonStats photons;
    uint64_t texels = 0;  // in the atlas
    uint64_t validPhatexels = 0;
    uint64_t darkTexels = 0;  // BakeSettings::dynamic: texels of sides that no light reaches yet
    uint64_t rays = 0;        // traced after the photons
    double seconds = 0;
    KeptParts kept;
};

struct Bake {
    Atlas atlas;
    TexelPoints points;
    Phatexture phatexture;
    BakeStats stats;
    StageKeys keys = {};
};

/// Results of an earlier bake, and the keys of what they were computed from.
struct EarlierResults {
    const TexelPoints& points;
    const Phatexture& phatexture;
    StageKeys keys;
};

/// A bake that this one continues.
struct EarlierBake {
    EarlierCharts charts;
    std::optional<EarlierResults> results;  // none: all is computed again
};

/// Throws Interrupted when `progress` requests it, std::invalid_argument for splats without photon
/// directions. With an `earlier` bake its charts are kept (buildAtlasOn); with its results, too, the bake is
/// the same but takes less time.
Bake bake(const RayScene& rays, const BakeSettings& settings, Progress& progress,
          BakeJournal* journal = nullptr, const EarlierBake* earlier = nullptr);
inline Bake bake(const Scene& scene, const BakeSettings& settings, Progress& progress,
                 BakeJournal* journal = nullptr) {
    return bake(RayScene(scene), settings, progress, journal);
}

/// Upper estimate of the memory that bake() needs, in bytes, before anything is allocated.
uint64_t estimateBakeMemory(const Scene& scene, const BakeSettings& settings);

}  // namespace phat
