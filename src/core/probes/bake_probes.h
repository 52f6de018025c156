#pragma once
// From a finished bake to light probes.

#include <atomic>

#include "core/bake/journal.h"
#include "core/base/progress.h"
#include "core/phatexel/phatexture.h"
#include "core/probes/light_probes.h"
#include "core/scene/rays.h"

namespace phat {

struct ProbeSettings {
    int count = 2048;  // at most; 0: none
    uint64_t seed = 1;
};

/// A baked scene. pre: `phatexture` has irradiance.
struct ProbeInput {
    const RayScene& rays;
    const Atlas& atlas;
    const TexelPoints& points;
    const Phatexture& phatexture;
};

/// How the probes are made: progress, and the journal that an interrupted run is taken up from.
struct ProbeRun {
    Progress& progress;
    BakeJournal* journal;  // null: an interrupted run begins anew
    std::atomic<uint64_t>& rayCount;
};

/// Probes over the box of the scene without its ground. A third of them are the corners of a grid; its cells
/// are divided, and their parts once more, where the light at the corners differs most. Cells without light
/// at any corner, which are inside solids, outside of a closed room or in one without light, have none.
/// Throws Interrupted.
LightProbes bakeLightProbes(const ProbeInput& input, const ProbeSettings& settings, const ProbeRun& run);

}  // namespace phat
