#pragma once
// Irradiance of moved objects. Their texels move with them, so their irradiance is visibly wrong once they
// have turned, and it is little: it is updated from estimates to maps on its own, also while a map of all is
// being made.

#include "core/dynamic/map_updater.h"

namespace phat {

class MovedObjects {
  public:
    MovedObjects(BakerState& state, MapUpdater& maps) : state_(state), maps_(maps) {}

    /// Whether objects have moved whose irradiance has not been updated since.
    bool hasWork() const { return step_ != Step::none || anyMoved(); }
    /// Goes on for a slice. Returns the work.
    uint64_t advance();
    /// How often everything that had moved was mapped.
    uint64_t rounds() const { return rounds_; }

  private:
    enum class Step { none, estimates, areaMap, nodes, indirectMap };
    bool anyMoved() const;
    void beginRound();
    void begin(Step step);
    void listBlocks();
    void listNodeGroups();
    /// Returns the next items of the step, so many at most.
    std::span<const uint32_t> takeItems(size_t count);
    uint64_t advanceEstimates();
    uint64_t advanceNodes();

    BakerState& state_;
    MapUpdater& maps_;
    Step step_ = Step::none;
    ChartSet charts_;              // of the round
    std::vector<uint32_t> items_;  // of the step
    size_t next_ = 0;
    uint64_t version_ = 1;  // of the scene at the last round; objects moved since are next
    uint64_t rounds_ = 0;
};

}  // namespace phat
