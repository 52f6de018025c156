#include "core/dynamic/baker_thread.h"

#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/stopwatch.h"

namespace phat {
namespace {

// Rays between two looks at what is wanted: some milliseconds of a core.
constexpr uint64_t kWorkAtOnce = 10'000;
// The speed is that of about so long.
constexpr double kSpeedSeconds = 1;

}  // namespace

class BakerThread::Stop : public SilentProgress {
  public:
    explicit Stop(const std::atomic<bool>& stop) : stop_(stop) {}
    bool stopRequested() const override { return stop_; }

  private:
    const std::atomic<bool>& stop_;
};

BakerThread::BakerThread(const Start& start, int cores, Wake wake) : wake_(std::move(wake)) {
    const int used = cores > 0 ? cores : std::max(1, tbb::this_task_arena::max_concurrency() - 1);
    thread_ = std::thread([this, start, used] {
        try {
            tbb::task_arena(used).execute([&] { run(start); });
        } catch (const Interrupted&) {  // only when this ends
        } catch (...) {
            {
                const std::lock_guard lock(mutex_);
                failure_ = std::current_exception();
                started_ = true;
                report_.converged = true;
            }
            changed_.notify_all();
            wake_();
        }
    });
}

BakerThread::~BakerThread() {
    {
        const std::lock_guard lock(mutex_);
        quit_ = true;
    }
    stop_ = true;
    changed_.notify_all();
    thread_.join();
}

void BakerThread::follow(const SceneState& state, const Camera& eye, bool updatesLight, bool refines) {
    {
        const std::lock_guard lock(mutex_);
        wanted_ = Wanted{state, eye, updatesLight, refines};
        report_.converged = false;
    }
    changed_.notify_all();
}

std::optional<LightUpdate> BakerThread::take() {
    std::optional<LightUpdate> taken;
    {
        const std::lock_guard lock(mutex_);
        if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
        taken = std::exchange(ready_, std::nullopt);
    }
    if (taken) changed_.notify_all();
    return taken;
}

void BakerThread::waitUntilStarted() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return started_; });
}

BakerThread::Report BakerThread::report() const {
    const std::lock_guard lock(mutex_);
    return report_;
}

void BakerThread::run(const Start& start) {
    IncrementalBaker engine(start.rest, start.atlas, start.points, start.baked, start.settings);
    {
        const std::lock_guard lock(mutex_);
        started_ = true;
    }
    changed_.notify_all();
    while (step(engine)) {
    }
}

bool BakerThread::step(IncrementalBaker& engine) {
    std::optional<Wanted> wanted;
    bool updatesLight = false, refines = false;
    {
        const std::lock_guard lock(mutex_);
        if (quit_) return false;
        wanted = std::exchange(wanted_, std::nullopt);
        if (wanted) {
            updatesLight_ = wanted->updatesLight;
            refines_ = wanted->refines;
        }
        updatesLight = updatesLight_;
        refines = refines_;
    }
    if (wanted) {
        engine.setEye(&wanted->eye);
        engine.setSceneState(wanted->state);
    }
    const Stopwatch start;
    const double processorStart = threadProcessorSeconds();
    // A pass of refinement waits where it is.
    const bool rests = !updatesLight || engine.converged() || (engine.passes() > 0 && !refines);
    if (!rests) engine.advance(kWorkAtOnce, Stop(stop_));
    noteWork(engine, start.seconds(), threadProcessorSeconds() - processorStart);

    bool taker = false;
    {
        const std::lock_guard lock(mutex_);
        taker = !ready_;
    }
    // Put together without the lock: whoever draws must not wait for it.
    LightUpdate update;
    if (taker) update = engine.drainUpdate();
    const bool any = !update.empty();
    // A look at every item: for those who are told of something new alone.
    const UpToDateShares renewed = any || rests ? engine.upToDate() : UpToDateShares{};
    std::unique_lock lock(mutex_);
    if (any || rests) report_.upToDate = renewed;
    if (any) ready_ = std::move(update);
    // All is done and the last portion is on its way.
    const bool goesOn = updatesLight && refines && engine.passes() < kMostRefinements;
    const bool done = rests && taker && !wanted_ && !goesOn;
    report_.refinements = rests && goesOn ? engine.passes() : std::max(engine.passes(), 1u) - 1;
    if (rests && taker && !any && !wanted_ && goesOn) {
        lock.unlock();
        engine.refine();
        return true;
    }
    if (done != report_.converged || any) {
        if (done) report_.converged = true;
        lock.unlock();
        wake_();
        lock.lock();
    }
    if (rests) changed_.wait(lock, [&] { return quit_ || wanted_ || (!done && !ready_); });
    return !quit_;
}

void BakerThread::noteWork(const IncrementalBaker& engine, double seconds, double processor) {
    const std::lock_guard lock(mutex_);
    const uint64_t now = engine.stats().phatexels, more = now - report_.phatexels;
    report_.phatexels = now;
    report_.seconds += seconds;
    report_.processorSeconds += processor;
    report_.longestSeconds = std::max(report_.longestSeconds, processor);
    // An exponential mean.
    const float keep = float(std::exp(-seconds / kSpeedSeconds));
    recentSeconds_ = recentSeconds_ * keep + seconds;
    recentPhatexels_ = uint64_t(double(recentPhatexels_) * keep) + more;
    if (recentSeconds_ > 0) report_.phatexelsPerSecond = double(recentPhatexels_) / recentSeconds_;
}

}  // namespace phat
