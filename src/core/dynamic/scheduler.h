#pragma once
// What the incremental baker does next: which task, and which of its items. source: the idea of updating
// first what matters most, and everything in bounded time, is that of Bishop et al. 1994, "Frameless
// Rendering".

#include "core/dynamic/baker_state.h"
#include "core/dynamic/fair_queue.h"

namespace phat {

/// Work that is not in the scheduler's queues.
struct UnqueuedWork {
    bool moved = false;             // the irradiance of moved objects
    bool maps = false;              // a map is being made
    bool areaMapStale = false;      // it is being made, or has to be
    bool indirectMapStale = false;  // likewise
};

/// Holds a queue of stale items for each task but `moved` and `maps`. The queues are as of the last replan().
class Scheduler {
  public:
    /// Whose visible tiles come first, from the next replan() on; null: all are alike.
    void setCamera(const Camera* camera);
    /// The scene has changed at this clock.
    void noteChange(uint64_t clock);

    /// Whether the queues are of the state's present revision.
    bool isCurrent(const BakerState& state) const { return planned_ == state.revision; }
    /// Queues the stale items of every task, the most urgent first: those of the highest value plus age. The
    /// age grows by 1 in the time of a pass over the atlas, so that everything is updated in bounded time.
    /// Does nothing where the queues are current. pre: the state's nodes are adapted.
    void replan(const BakerState& state, const UnqueuedWork& other);

    /// Whether the task has anything to do.
    bool hasWork(BakerTask task, const UnqueuedWork& other) const;
    /// Whether the task must wait because its inputs are not up to date.
    bool waits(BakerTask task, const UnqueuedWork& other) const;
    bool areaIsKnown(const UnqueuedWork& other) const;
    bool indirectIsKnown(const UnqueuedWork& other) const;

    /// Takes the task that is due. None: there is nothing to do.
    std::optional<BakerTask> takeTask(const UnqueuedWork& other);
    /// Takes the next items of the task, as many as a slice of work has.
    std::span<const uint32_t> takeItems(BakerTask task);
    /// To be called after a slice of `task`, with the clock after it.
    void charge(BakerTask task, uint64_t work, uint64_t clock);

  private:
    struct Queue {
        std::vector<uint32_t> items;  // the most urgent first
        size_t next = 0;
    };
    /// Changes follow each other, so that nothing is ever up to date in full.
    bool keepsChanging() const;

    std::array<Queue, kBakerTasks> queues_;
    uint64_t planned_ = 0;  // BakerState::revision of the queues
    FairQueue shares_;
    std::optional<Camera> camera_;
    std::vector<float> tileValue_;
    uint64_t valuesVersion_ = 0;  // of the scene; 0: to be computed
    uint64_t clock_ = 0;
    uint64_t stillWork_ = 0;                 // changes that are no farther apart are one motion
    std::array<uint64_t, 2> changeClock_{};  // of the last change and of the one before
};

}  // namespace phat
