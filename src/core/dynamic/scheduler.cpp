#include "core/dynamic/scheduler.h"

#include <algorithm>

#include "core/dynamic/urgency.h"

namespace phat {
namespace {

// Changes that are no farther apart are one motion, in rays a texel.
constexpr uint64_t kStillWork = 32;

// Items of a slice of work, by BakerTask: some ten milliseconds, and enough for many threads.
constexpr size_t kItemsPerSlice[kBakerTasks] = {0, 64, 1, 4, 1024, 0, 8};

}  // namespace

void Scheduler::setCamera(const Camera* camera) {
    camera_ = camera ? std::optional<Camera>(*camera) : std::nullopt;
    valuesVersion_ = 0;
}

void Scheduler::noteChange(uint64_t clock) {
    changeClock_ = {std::max<uint64_t>(clock, 1), changeClock_[0]};
}

void Scheduler::replan(const BakerState& state, const UnqueuedWork& other) {
    if (isCurrent(state)) return;
    stillWork_ = kStillWork * state.scene.atlas().texelCount();
    clock_ = state.clock;
    if (valuesVersion_ != state.scene.version()) {
        tileValue_ = tileValues(state, camera_ ? &*camera_ : nullptr);
        valuesVersion_ = state.scene.version();
    }
    for (size_t t = 0; t < kBakerTasks; ++t) {
        const BakerTask task = BakerTask(t);
        // Of blocks, which come last: the other queues are new by then.
        const bool irradianceKnown = areaIsKnown(other) && indirectIsKnown(other);
        queues_[t] = {urgentFirst(state, task, tileValue_, irradianceKnown), 0};
    }
    planned_ = state.revision;
}

bool Scheduler::hasWork(BakerTask task, const UnqueuedWork& other) const {
    if (task == BakerTask::moved) return other.moved;
    if (task == BakerTask::maps) return other.maps;
    const Queue& queue = queues_[size_t(task)];
    return queue.next < queue.items.size();
}

bool Scheduler::areaIsKnown(const UnqueuedWork& other) const {
    return !other.areaMapStale && !hasWork(BakerTask::areaLight, other);
}

bool Scheduler::indirectIsKnown(const UnqueuedWork& other) const {
    return !other.indirectMapStale && !hasWork(BakerTask::nodes, other);
}

bool Scheduler::keepsChanging() const {
    return clock_ - changeClock_[0] < stillWork_ && changeClock_[1] > 0 &&
           changeClock_[0] - changeClock_[1] < stillWork_;
}

bool Scheduler::waits(BakerTask task, const UnqueuedWork& other) const {
    if ((task != BakerTask::nodes && task != BakerTask::blocks) || keepsChanging()) return false;
    if (task == BakerTask::nodes) return !areaIsKnown(other);
    return !areaIsKnown(other) || !indirectIsKnown(other) || hasWork(BakerTask::photons, other);
}

std::optional<BakerTask> Scheduler::takeTask(const UnqueuedWork& other) {
    std::array<bool, kBakerTasks> busy{};
    for (size_t t = 0; t < kBakerTasks; ++t)
        busy[t] = hasWork(BakerTask(t), other) && !waits(BakerTask(t), other);
    return shares_.next(busy);
}

std::span<const uint32_t> Scheduler::takeItems(BakerTask task) {
    Queue& queue = queues_[size_t(task)];
    const size_t first = queue.next;
    queue.next = std::min(first + kItemsPerSlice[size_t(task)], queue.items.size());
    return std::span(queue.items).subspan(first, queue.next - first);
}

void Scheduler::charge(BakerTask task, uint64_t work, uint64_t clock) {
    clock_ = clock;
    shares_.charge(task, work);
}

}  // namespace phat
