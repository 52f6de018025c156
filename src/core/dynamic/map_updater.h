#pragma once
// Updates the irradiance maps: the estimates and rays that they are made from, and the maps, slice by slice.

#include <atomic>
#include <cassert>

#include "core/bake/seam_stitch.h"
#include "core/base/resumable_task.h"
#include "core/dynamic/baker_state.h"

namespace phat {

enum class MapKind : uint8_t { area, indirect };

/// A map that is being made anew. Never moved: its slices refer to it.
struct MapJob {
    MapKind kind = MapKind::area;
    ChartSet charts;  // empty: all
    ChartSet newer;   // of all: mapped again since it began, alone
    IrradianceMap map;
    std::atomic<uint64_t> rays = 0;
    SilentProgress progress;
    std::optional<ResumableTask> slices;
};

class MapUpdater {
  public:
    explicit MapUpdater(BakerState& state);

    /// Estimates the area lights' irradiance of the blocks' texels. Returns the work.
    uint64_t estimateArea(std::span<const BlockRect> blocks);
    /// Likewise of squares of 32x32 texels of the atlas.
    uint64_t estimateRegions(std::span<const uint32_t> regions);
    /// Adapts the nodes of indirect irradiance to the texels that are occluded now.
    void adaptNodes();
    /// Traces the rays of nodes. Returns the work.
    uint64_t traceNodes(std::span<const uint32_t> nodes);

    /// Begins with the maps of all charts that are due: their inputs are up to date, as the arguments say, or
    /// have changed enough.
    void beginDue(bool allEstimated, bool allTraced);
    /// Whether a map of all charts is being made.
    bool isRunning() const { return areaJob_ || indirectJob_; }
    /// Whether its inputs have changed since the map was last begun, or it is being made.
    bool areaIsStale() const { return areaDirty_ || areaJob_; }
    bool indirectIsStale() const { return indirectDirty_ || indirectJob_; }

    struct Slice {
        MapKind kind = MapKind::area;
        uint64_t work = 0;
        bool finished = false;
    };
    /// Goes on with the map of all charts. pre: isRunning().
    Slice advance();

    /// Begins with the map of some charts alone, whatever is being made of all. pre: !chartsAreRunning().
    void beginCharts(MapKind kind, const ChartSet& charts) {
        assert(!chartsAreRunning());
        begin(chartsJob_, kind, charts);
    }
    bool chartsAreRunning() const { return chartsJob_.has_value(); }
    /// Goes on with it. Returns the work. pre: chartsAreRunning().
    uint64_t advanceCharts() {
        assert(chartsAreRunning());
        return advance(chartsJob_);
    }

    /// A pass of refinement begins: what has been made so far becomes part of the means. pre: no map is
    /// stale.
    void beginPass();

  private:
    bool areaIsDue(bool allEstimated) const;
    bool indirectIsDue(bool allTraced) const;
    void begin(std::optional<MapJob>& job, MapKind kind, ChartSet charts);
    /// Returns the work; empties `job` when it is done.
    uint64_t advance(std::optional<MapJob>& job);
    void publish(MapJob& job);
    /// Whether the updated map differs from the one that is shown, which it replaces.
    bool replace(std::vector<uint32_t>& shown, std::vector<uint32_t> updated);
    uint64_t texelsOf(const ChartSet& charts) const;

    BakerState& state_;
    std::vector<SeamPoint> seams_;
    std::vector<IrradianceEstimate> areaEstimates_;  // [y][x]
    IrradianceMap areaMap_, indirectMap_;            // before their seams are stitched
    IrradianceMap areaMean_, indirectMean_;          // of the passes of refinement before the present one
    bool areaDirty_ = false, indirectDirty_ = true;  // inputs have changed
    uint64_t areaWork_ = 0, nodeWork_ = 0;           // on inputs, since the maps were last begun
    std::optional<MapJob> areaJob_, indirectJob_;    // of all charts
    std::optional<MapJob> chartsJob_;
};

}  // namespace phat
