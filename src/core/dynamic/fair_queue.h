#pragma once
// Which task runs next, so that each receives work in proportion to its weight.

#include <optional>

#include "core/dynamic/baker_task.h"

namespace phat {

/// A task's weight: with all tasks busy it gets this part of the sum of all weights of the work.
double taskWeight(BakerTask task);

/// Distributes the work among the tasks by their weights.
/// source: start-time fair queuing, Goyal et al. 1996.
class FairQueue {
  public:
    /// The task to go on with; none when no flag is set.
    std::optional<BakerTask> next(const std::array<bool, kBakerTasks>& hasWork);
    void charge(BakerTask task, uint64_t work);

  private:
    std::array<double, kBakerTasks> served_{};  // work over weight
    std::array<bool, kBakerTasks> busy_{};
    double now_ = 0;
};

}  // namespace phat
