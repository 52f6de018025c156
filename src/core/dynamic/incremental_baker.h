#pragma once
// Dynamic light: a bake that follows a scene. source: Hensley et al. 2003, section 8 (PHATexels renewed one
// by one while the picture keeps moving); how is ours (docs/dynamic.md).
//
// The engine keeps the intermediate results of a bake and updates them piece by piece, by the bake's own
// functions and random numbers. Every piece knows which scene it was made from; once all are of the present
// one, the PHATexels are those that a bake of it on this atlas makes, bit by bit.

#include <atomic>
#include <string>

#include "core/base/resumable_task.h"
#include "core/dynamic/phatexel_updater.h"
#include "core/dynamic/scheduler.h"

namespace phat {

/// What has been done so far, by BakerTask.
struct BakerStats {
    struct Task {
        uint64_t items = 0;  // times all that moved was mapped, tiles, parts of the photon map, regions, ...
        uint64_t work = 0;
        double seconds = 0;
    };
    std::array<Task, kBakerTasks> tasks;
    Task areaMaps, indirectMaps;  // filtered, bounced and stitched
    uint64_t phatexels = 0;       // renewed
};

/// How much of each task's items is of the scene as it is, from 0 to 1, by BakerTask.
using UpToDateShares = std::array<float, kBakerTasks>;

class IncrementalBaker {
  public:
    /// `points`: of the scene at rest, covered ones marked. `baked`: its bake by these settings, or empty:
    /// then the engine makes it. Throws std::invalid_argument for directions or radiance from single photons.
    IncrementalBaker(const Scene& rest, const Atlas& atlas, const TexelPoints& points,
                     const Phatexture& baked, const BakeSettings& settings);

    /// The scene as it is from now on. Its geometry is in place at once, its light follows by advance().
    /// Returns whether anything is different.
    bool setSceneState(const SceneState& state);
    /// Makes all light of the scene anew with other draws: its PHATexels take the place of the last ones, to
    /// be averaged by who draws them; irradiance becomes the mean of all passes. The next change of the scene
    /// begins with the first draws again. pre: converged(), and all updates are taken.
    void refine();
    /// How often that was done since the last change.
    uint32_t passes() const { return state_.pass; }
    /// Whose picture comes first; null: nobody looks.
    void setEye(const Camera* eye);

    /// Goes on for about `work`, counted in rays or what takes as long; a piece that takes more is made up
    /// for by the next calls. The state depends on the calls alone, not on threads or time. Returns what was
    /// done: nothing while earlier pieces are made up for, or when all is converged. Throws Interrupted when
    /// `progress` asks, between pieces.
    uint64_t advance(uint64_t work, const Progress& progress);
    bool converged();
    /// Goes on until it is; returns the work.
    uint64_t converge(const Progress& progress);

    /// All that has changed since the last call.
    LightUpdate drainUpdate();

    const DynamicScene& scene() const { return state_.scene; }
    const RayScene& rays() const { return *state_.rays; }
    const LightSampler& lights() const { return *state_.lights; }
    const Phatexture& phatexture() const { return state_.phatexture; }
    const BakerStats& stats() const { return stats_; }
    UpToDateShares upToDate() const;

  private:
    struct Queue {
        std::vector<uint32_t> items;  // the most urgent first
        size_t next = 0;
        uint64_t planned = 0;  // queueVersion_ that it was made for
    };
    bool hasWork(BakerTask task);
    /// Changes follow each other, so that nothing is ever known in full.
    bool keepsChanging() const;
    /// Whether the task would only have to be done again when what it depends on is known.
    bool waits(BakerTask task);
    bool areaIsKnown() { return !areaJob_ && !areaDirty_ && !hasWork(BakerTask::areaLight); }
    bool indirectIsKnown() { return !indirectJob_ && !indirectDirty_ && !hasWork(BakerTask::nodes); }
    std::span<const uint32_t> takeItems(BakerTask task, size_t most);
    void runSlice(BakerTask task, Progress& progress);
    uint64_t retraceInvalidated();
    uint64_t tracePhotonPart(Progress& progress);
    uint64_t updateRegions();
    uint64_t traceNodes(std::span<const uint32_t> nodes);
    uint64_t estimateArea(std::span<const BlockPlace> places);
    uint64_t updateBlocks();
    /// A map that is being made anew. Never moved: its pieces refer to it.
    struct MapJob {
        bool area = false;
        ChartSet charts;  // empty: all
        ChartSet newer;   // of all: mapped again since it began, alone
        IrradianceMap map;
        std::atomic<uint64_t> rays = 0;
        SilentProgress progress;
        std::optional<ResumableTask> pieces;
    };
    /// The irradiance of what has moved, from estimates and rays to maps, before and beside that of all else.
    struct MovedLight {
        enum class Step { none, estimates, areaMap, nodes, indirectMap };
        Step step = Step::none;
        ChartSet charts;
        std::vector<uint32_t> items;  // of the step
        size_t next = 0;
        std::optional<MapJob> job;
        uint64_t scene = 1;  // version: what moved after that comes next
    };
    uint64_t updateMoved();
    void beginMovedStep(MovedLight::Step step);
    bool anyMoved() const;
    ChartSet movedSince(uint64_t version) const;

    /// Begins with the maps of all that are due.
    void beginDueMaps();
    void beginMap(std::optional<MapJob>& job, bool area, ChartSet charts);
    /// Returns the work; empties `job` when it is done.
    uint64_t advanceMap(std::optional<MapJob>& job);
    uint64_t advanceWholeMaps();
    void publishMap(MapJob& job);
    uint64_t texelsOf(const ChartSet& charts) const;
    bool areaIsDue();
    bool indirectIsDue();

    void setSeeds();

    BakerState state_;
    uint64_t seed_, photonSeed_;  // of the bake
    std::optional<Camera> eye_;
    std::vector<float> tileValue_;
    uint64_t valuesFor_ = 0;  // version
    std::array<Queue, kBakerTasks> queues_;
    uint64_t queueVersion_ = 1;  // grows when something may have become stale
    FairQueue shares_;
    int64_t workBudget_ = 0;
    uint64_t clock_ = 0;                 // all work so far
    std::array<uint64_t, 2> changes_{};  // clock at the last change and at the one before
    bool areaDirty_ = false, indirectDirty_ = false;
    uint64_t areaWork_ = 0, nodeWork_ = 0;  // since the maps were last made
    std::vector<glm::vec4> tileLight_;      // as last made, see tileLight()
    uint64_t tileLightScene_ = 0;           // that was last sent for
    bool tileLightStale_ = false;
    uint64_t tileLightClock_ = 0;  // of the next one
    BakerStats stats_;
    std::optional<MapJob> areaJob_, indirectJob_;  // of all charts
    MovedLight moved_;
};

}  // namespace phat
