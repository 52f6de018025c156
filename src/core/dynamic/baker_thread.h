#pragma once
// The incremental baker on a thread of its own, for a window that goes on drawing.

#include <atomic>
#include <condition_variable>
#include <exception>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>

#include "core/dynamic/incremental_baker.h"

namespace phat {

/// The noise of one bake is an eighth by then, and further passes are hardly visible.
inline constexpr uint32_t kMaxRefinements = 64;

class BakerThread {
  public:
    /// Called from the thread when there is something to take; must be safe from any thread.
    using Wake = std::function<void()>;
    /// What it begins with; its thread reads it until waitUntilStarted() returns. pre: `rest` is at rest.
    struct Start {
        SharedSnapshot rest;
        const Atlas& atlas;
        const TexelPoints& points;
        const Phatexture& baked;
        BakeSettings settings;
    };
    /// `cores` 0: all but the window's.
    BakerThread(const Start& start, int cores, Wake wake);
    /// Stops in the middle of a slice of work.
    ~BakerThread();
    BakerThread(const BakerThread&) = delete;
    BakerThread& operator=(const BakerThread&) = delete;

    void waitUntilStarted();
    /// The scene from now on, and the camera whose visible tiles are updated first. Returns at once.
    /// `updatesLight` false: geometry follows, light waits. `refines`: once the light has converged, it is
    /// made anew with other random numbers (IncrementalBaker::refine), kMaxRefinements times.
    void follow(SharedSnapshot scene, const Camera& eye, bool updatesLight, bool refines = false);
    /// What has changed since the last call, if there is anything. The next update is put together only after
    /// that, so a slow taker finds more in one update, not more updates. Throws what the baker threw.
    std::optional<LightUpdate> take();

    struct Report {
        bool converged = true;  // no update follows the one that can be taken now
        UpToDateFractions upToDate{};
        uint32_t refinements = 0;  // done since the last change
        uint64_t phatexels = 0;    // so far
        double seconds = 0;        // of work so far
        double phatexelsPerSecond = 0;
        double processorSeconds = 0;  // of the baker's thread: of all work, where it has one core
        double longestSeconds = 0;    // by the clock, between two looks at the request: so long one may wait
    };
    Report report() const;

  private:
    struct Request {
        SharedSnapshot scene;
        Camera eye;
        bool updatesLight = true, refines = false;
    };
    /// The baker's activity between two checks for a new request.
    enum class Activity {
        updating,       // some of the light is not up to date
        passConverged,  // all of it is, and another pass of refinement follows
        resting,        // there is nothing to do until the next request
    };
    enum class Handover { takerIsBusy, nothingNew, handedOver };
    class Stop;
    void run(const Start& start);
    /// Works for some milliseconds, or waits where there is nothing to do. Returns false at the end.
    bool step(IncrementalBaker& baker);
    /// Passes a new request on to the baker. Returns false at the end.
    bool acceptRequest(IncrementalBaker& baker);
    Activity activityOf(const IncrementalBaker& baker) const;
    void update(IncrementalBaker& baker);
    /// Assembles an update of all changes, if the last one has been taken, and reports.
    Handover handOver(IncrementalBaker& baker, Activity activity);
    bool hasRequest() const;
    /// Waits for a request or, where `forTaker`, until the last update has been taken. Returns false at the
    /// end.
    bool waitForChange(bool forTaker);
    void noteStep(double seconds);
    void noteWork(uint64_t phatexels, double seconds, double processorSeconds);

    Wake wake_;
    bool updatesLight_ = true, refines_ = false;  // of the request that was accepted; of the thread alone
    mutable std::mutex mutex_;                    // guards the members below but stop_ and thread_
    std::condition_variable changed_;
    std::optional<Request> request_;  // not yet accepted
    std::optional<LightUpdate> ready_;
    std::exception_ptr failure_;
    Report report_;
    bool started_ = false, quit_ = false;
    std::atomic<bool> stop_ = false;
    double recentSeconds_ = 0;  // of the speed that is reported
    uint64_t recentPhatexels_ = 0;
    std::thread thread_;
};

}  // namespace phat
