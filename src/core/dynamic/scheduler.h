#pragma once
// What the incremental baker does first. source: the idea of renewing what matters most, everything in a
// bounded time, is that of Bishop et al. 1994, "Frameless Rendering".

#include "core/dynamic/baker_state.h"

namespace phat {

/// What can be worth doing.
enum class BakerTask : uint8_t { moved, retraceInvalidated, photons, areaLight, nodes, maps, blocks };
inline constexpr size_t kBakerTasks = 7;

/// How much a tile gains by being renewed, from 0 to 1.25: near to what has changed of late and facing it, in
/// the picture. `eye` null: all are in the picture.
std::vector<float> tileValues(const BakerState& state, const Camera* eye);

/// The stale items of a task, the most urgent first. An item's urgency grows with its age by 1 in
/// `passClock` ticks, so that it cannot wait longer than that and a little.
std::vector<uint32_t> urgentFirst(const BakerState& state, BakerTask task,
                                  const std::vector<float>& tileValue, uint64_t clock, uint64_t passClock);

/// Shares the work out to tasks by weight: each gets its share of what is done while it has something to do.
/// source: start-time fair queuing, Goyal et al. 1996.
class FairQueue {
  public:
    /// The task to go on with; none when no flag is set.
    std::optional<BakerTask> next(const std::array<bool, kBakerTasks>& hasWork);
    void done(BakerTask task, uint64_t work);

  private:
    std::array<double, kBakerTasks> served_{};  // work over weight
    std::array<bool, kBakerTasks> busy_{};
    double now_ = 0;
};

}  // namespace phat
