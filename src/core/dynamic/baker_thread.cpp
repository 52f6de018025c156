#include "core/dynamic/baker_thread.h"

#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/stopwatch.h"

namespace phat {
namespace {

// Rays between two looks at the request: some milliseconds of a core.
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

void BakerThread::follow(SharedSnapshot scene, const Camera& eye, bool updatesLight, bool refines) {
    {
        const std::lock_guard lock(mutex_);
        request_ = Request{std::move(scene), eye, updatesLight, refines};
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
    IncrementalBaker baker(start.rest, start.atlas, start.points, start.baked, start.settings);
    {
        const std::lock_guard lock(mutex_);
        started_ = true;
    }
    changed_.notify_all();
    while (step(baker)) {
    }
}

bool BakerThread::acceptRequest(IncrementalBaker& baker) {
    std::optional<Request> request;
    {
        const std::lock_guard lock(mutex_);
        if (quit_) return false;
        request = std::exchange(request_, std::nullopt);
    }
    if (!request) return true;
    updatesLight_ = request->updatesLight;
    refines_ = request->refines;
    baker.setEye(&request->eye);
    baker.setScene(std::move(request->scene));
    return true;
}

BakerThread::Activity BakerThread::activityOf(const IncrementalBaker& baker) const {
    if (!updatesLight_) return Activity::resting;
    // A pass of refinement is suspended where it is.
    if (baker.passes() > 0 && !refines_) return Activity::resting;
    if (!baker.converged()) return Activity::updating;
    return refines_ && baker.passes() < kMaxRefinements ? Activity::passConverged : Activity::resting;
}

void BakerThread::update(IncrementalBaker& baker) {
    const Stopwatch start;
    const double processorStart = threadProcessorSeconds();
    baker.advance(kWorkAtOnce, Stop(stop_));
    noteWork(baker.stats().phatexels, start.seconds(), threadProcessorSeconds() - processorStart);
}

BakerThread::Handover BakerThread::handOver(IncrementalBaker& baker, Activity activity) {
    bool taken = false;
    {
        const std::lock_guard lock(mutex_);
        taken = !ready_;
    }
    // Put together without the lock: the renderer must not wait for it.
    LightUpdate update;
    if (taken) update = baker.drainUpdate();
    const bool any = !update.empty();
    // The fractions need a pass over every item: only where there is something new to report.
    const bool reports = any || activity != Activity::updating;
    const UpToDateFractions fractions = reports ? baker.upToDate() : UpToDateFractions{};
    bool nowConverged = false;
    {
        const std::lock_guard lock(mutex_);
        if (reports) report_.upToDate = fractions;
        report_.refinements =
            activity == Activity::passConverged ? baker.passes() : std::max(baker.passes(), 1u) - 1;
        if (any) ready_ = std::move(update);
        // All is done and the last update can be taken.
        nowConverged = activity == Activity::resting && taken && !request_ && !report_.converged;
        if (nowConverged) report_.converged = true;
    }
    if (any || nowConverged) wake_();
    if (!taken) return Handover::takerIsBusy;
    return any ? Handover::handedOver : Handover::nothingNew;
}

bool BakerThread::hasRequest() const {
    const std::lock_guard lock(mutex_);
    return request_.has_value();
}

bool BakerThread::waitForChange(bool forTaker) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return quit_ || request_ || (forTaker && !ready_); });
    return !quit_;
}

bool BakerThread::step(IncrementalBaker& baker) {
    const Stopwatch sinceLook;
    if (!acceptRequest(baker)) return false;
    const Activity activity = activityOf(baker);
    if (activity == Activity::updating) update(baker);
    const Handover handover = handOver(baker, activity);
    noteStep(sinceLook.seconds());
    switch (activity) {
        case Activity::updating:
            return true;
        case Activity::passConverged:
            // The next pass replaces the PHATexels of this one, so all of those must have been taken.
            if (handover != Handover::nothingNew) return waitForChange(true);
            if (!hasRequest()) baker.refine();
            return true;
        case Activity::resting:
            return waitForChange(handover == Handover::takerIsBusy);
    }
    return false;
}

void BakerThread::noteStep(double seconds) {
    const std::lock_guard lock(mutex_);
    report_.longestSeconds = std::max(report_.longestSeconds, seconds);
}

void BakerThread::noteWork(uint64_t phatexels, double seconds, double processorSeconds) {
    const std::lock_guard lock(mutex_);
    const uint64_t more = phatexels - report_.phatexels;
    report_.phatexels = phatexels;
    report_.seconds += seconds;
    report_.processorSeconds += processorSeconds;
    // An exponential mean.
    const float keep = float(std::exp(-seconds / kSpeedSeconds));
    recentSeconds_ = recentSeconds_ * keep + seconds;
    recentPhatexels_ = uint64_t(double(recentPhatexels_) * keep) + more;
    if (recentSeconds_ > 0) report_.phatexelsPerSecond = double(recentPhatexels_) / recentSeconds_;
}

}  // namespace phat
