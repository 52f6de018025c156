#pragma once
// Costs of a bake's stages, for the estimate of the remaining time.

#include "cli/progress_bar.h"
#include "core/bake/bake.h"
#include "core/probes/bake_probes.h"

namespace phat {

/// The stages that bake() and bakeLightProbes() will go through, in order. Those that the scene does not need
/// are skipped.
std::vector<PlannedStage> bakeStages(const BakeSettings& settings, const ProbeSettings& probes = {0});

}  // namespace phat
