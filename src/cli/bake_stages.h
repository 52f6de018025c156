#pragma once
// Costs of a bake's stages, for the estimate of the remaining time.

#include "cli/progress_bar.h"
#include "core/bake/bake.h"

namespace phat {

/// The stages that bake() will go through, in order. Those that the scene does not need are skipped.
std::vector<PlannedStage> bakeStages(const BakeSettings& settings);

}  // namespace phat
