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

/// The noise of one bake is an eighth by then, and whoever looks has seen it.
inline constexpr uint32_t kMostRefinements = 64;

class BakerThread {
  public:
    /// Called from the thread when there is something to take; must be safe from any thread.
    using Wake = std::function<void()>;
    /// What it begins with; its thread reads it until waitUntilStarted() returns.
    struct Start {
        const Scene& rest;
        const Atlas& atlas;
        const TexelPoints& points;
        const Phatexture& baked;
        BakeSettings settings;
    };
    /// `cores` 0: all but the window's.
    BakerThread(const Start& start, int cores, Wake wake);
    /// Stops in the middle of a piece of work.
    ~BakerThread();
    BakerThread(const BakerThread&) = delete;
    BakerThread& operator=(const BakerThread&) = delete;

    void waitUntilStarted();
    /// The scene from now on, and whose picture comes first. Returns at once. `updatesLight` false: geometry
    /// follows, light waits. `refines`: once all is of this scene, it is made anew with other draws
    /// (IncrementalBaker::refine), kMostRefinements times.
    void follow(const SceneState& state, const Camera& eye, bool updatesLight, bool refines = false);
    /// What has changed since the last call, if there is anything. The next is put together only after that,
    /// so a slow taker finds more in one portion, not more portions. Throws what the engine threw.
    std::optional<LightUpdate> take();

    struct Report {
        bool converged = true;  // nothing comes after what can be taken now
        UpToDateShares upToDate{};
        uint32_t refinements = 0;  // done since the last change
        uint64_t phatexels = 0;    // so far
        double seconds = 0;        // of work so far
        double phatexelsPerSecond = 0;
        double processorSeconds = 0;  // of its thread: all of them, where it has one core
        double longestSeconds = 0;    // between two looks at what is wanted
    };
    Report report() const;

  private:
    struct Wanted {
        SceneState state;
        Camera eye;
        bool updatesLight = true, refines = false;
    };
    class Stop;
    void run(const Start& start);
    /// Goes on until there is nothing to do, then waits; false: to end.
    bool step(IncrementalBaker& engine);
    void noteWork(const IncrementalBaker& engine, double seconds, double processorSeconds);

    Wake wake_;
    mutable std::mutex mutex_;
    std::condition_variable changed_;
    std::optional<Wanted> wanted_;                // not yet begun
    bool updatesLight_ = true, refines_ = false;  // of what was begun
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
