#include "core/dynamic/fair_queue.h"

#include <algorithm>

namespace phat {

double taskWeight(BakerTask task) {
    // Irradiance of moved objects is little work and visibly wrong until then; retracing after a change is
    // soon done, too. Nearly all else waits for a map once it has begun. Blocks that are updated before the
    // irradiance around them is up to date have to be updated again.
    constexpr double kWeights[kBakerTasks] = {100, 16, 2, 12, 4, 20, 4};
    return kWeights[size_t(task)];
}

std::optional<BakerTask> FairQueue::next(const std::array<bool, kBakerTasks>& hasWork) {
    std::optional<size_t> best;
    for (size_t t = 0; t < kBakerTasks; ++t) {
        // An idle task accumulates no credit.
        if (hasWork[t] && !busy_[t]) served_[t] = std::max(served_[t], now_);
        busy_[t] = hasWork[t];
        if (hasWork[t] && (!best || served_[t] < served_[*best])) best = t;
    }
    if (!best) return std::nullopt;
    now_ = served_[*best];
    return BakerTask(*best);
}

void FairQueue::charge(BakerTask task, uint64_t work) {
    served_[size_t(task)] += double(work) / taskWeight(task);
}

}  // namespace phat
