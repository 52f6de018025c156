#pragma once
// The order of a task's items.

#include "core/dynamic/baker_state.h"
#include "core/dynamic/baker_task.h"

namespace phat {

/// How much a tile gains by an update, from 1/16 to 1.25: near a recent change and facing it, in the view.
/// `camera` null: all tiles are in the view. 0 for tiles without a chart.
std::vector<float> tileValues(const BakerState& state, const Camera* camera);

/// The stale items of a task, the most urgent first. Urgency is the value of the item's best tile plus the
/// item's age in passes over the atlas. `irradianceKnown`: both maps are those of the scene as it is.
std::vector<uint32_t> urgentFirst(const BakerState& state, BakerTask task,
                                  const std::vector<float>& tileValue, bool irradianceKnown);

/// Rays in the time of a pass over the atlas.
uint64_t passWork(const Atlas& atlas);

}  // namespace phat
