#pragma once
// Dynamic lighting: a bake that follows a scene. source: Hensley et al. 2003, section 8 (PHATexels updated
// one by one while the picture keeps moving); how is ours (docs/dynamic.md).
//
// The baker keeps the intermediate results of a bake and updates them item by item, by the bake's own
// functions and random numbers. Every item knows which scene it was made from; once all are of the present
// one, the PHATexels are those that a bake of it on this atlas makes, bit by bit.

#include "core/dynamic/map_updater.h"
#include "core/dynamic/moved_objects.h"
#include "core/dynamic/phatexel_updater.h"
#include "core/dynamic/scheduler.h"
#include "core/dynamic/tile_light_sender.h"

namespace phat {

class IncrementalBaker {
  public:
    /// `points`: of the scene at rest, occluded ones marked. `baked`: its bake by these settings, or empty:
    /// then it is made here. Throws std::invalid_argument for directions or radiance from single photons.
    /// pre: `rest` is at rest.
    IncrementalBaker(SharedSnapshot rest, const Atlas& atlas, const TexelPoints& points,
                     const Phatexture& baked, const BakeSettings& settings);
    IncrementalBaker(const IncrementalBaker&) = delete;  // its parts refer to its state
    IncrementalBaker& operator=(const IncrementalBaker&) = delete;

    /// The scene as it is from now on. Its geometry is up to date at once, its light after advance().
    /// Returns whether anything is different. pre: a snapshot of the same PosedScene.
    bool setScene(SharedSnapshot snapshot);
    /// Makes all light of the scene anew with other random numbers: its PHATexels replace the last ones, to
    /// be averaged by the renderer; irradiance becomes the mean of all passes. The next change of the scene
    /// begins with the first random numbers again. pre: converged(), and all updates are taken.
    void refine();
    /// How often that was done since the last change.
    uint32_t passes() const { return state_.pass; }
    /// The camera whose visible tiles are updated first; null: no priority.
    void setEye(const Camera* eye) { scheduler_.setCamera(eye); }

    /// Advances by about `work`, in rays or their equivalent in time; a slice that takes more is made up
    /// for by the next calls. The state depends on the calls alone, not on threads or time. Returns what was
    /// done: nothing while earlier slices are made up for, or when all is converged. Throws Interrupted when
    /// `progress` requests it, between slices.
    uint64_t advance(uint64_t work, const Progress& progress);
    /// Whether everything is of the scene as it is.
    bool converged() const;
    /// Goes on until it is; returns the work.
    uint64_t converge(const Progress& progress);

    /// All that has changed since the last call.
    LightUpdate drainUpdate();

    const DynamicScene& scene() const { return state_.scene; }
    const RayScene& rays() const { return *state_.rays; }
    const LightSampler& lights() const { return *state_.lights; }
    const Phatexture& phatexture() const { return state_.phatexture; }
    const BakerStats& stats() const { return stats_; }
    UpToDateFractions upToDate() const;

  private:
    UnqueuedWork unqueuedWork() const;
    void setSeeds();
    /// Brings the scheduler's queues up to date.
    void replan();
    /// Runs a slice of the task.
    void runSlice(BakerTask task, Progress& progress);
    uint64_t runItems(BakerTask task, std::span<const uint32_t> items, Progress& progress);
    uint64_t advanceMaps();

    BakerState state_;
    uint64_t seed_, photonSeed_;  // of the bake
    MapUpdater maps_;
    MovedObjects moved_;
    PhatexelUpdater phatexels_;
    Scheduler scheduler_;
    TileLightSender tileLight_;
    int64_t workBudget_ = 0;
    BakerStats stats_;
};

}  // namespace phat
