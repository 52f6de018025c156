#pragma once
// How far long work is, on stderr.

#include <atomic>
#include <chrono>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "core/base/progress.h"

namespace phat {

/// A stage that is expected, and its cost relative to the others'.
struct PlannedStage {
    std::string name;
    double cost = 0;
};

enum class ProgressStyle {
    none,
    lines,    // a plain line now and then: logs
    oneLine,  // redrawn in place: terminals
};

/// oneLine where stderr is a terminal.
ProgressStyle progressStyle(bool quiet);

/// A stage that has ended.
struct StageTime {
    std::string name;
    double seconds = 0;
};

/// Draws reported progress; stopRequested() reflects the signals (interrupt.h). Stages that are not in
/// the plan are shown, but do not count for the time that is left. The terminal's line is gone when the bar
/// is.
class ProgressBar : public Progress {
  public:
    ProgressBar(ProgressStyle style, std::vector<PlannedStage> plan);
    ~ProgressBar() override;
    ProgressBar(const ProgressBar&) = delete;
    ProgressBar& operator=(const ProgressBar&) = delete;

    void begin(const char* stage, uint64_t total) override;
    void advance(uint64_t done) override;
    void end() override;
    bool stopRequested() const override;

    /// Times of the ended stages, those of one name together, in the order of their first ends.
    const std::vector<StageTime>& stageTimes() const { return stageTimes_; }

  private:
    using Clock = std::chrono::steady_clock;

    std::optional<double> secondsLeft(double stageSeconds, double stageFraction) const;
    void draw(bool last);

    const ProgressStyle style_;
    const std::vector<PlannedStage> plan_;
    const Clock::time_point start_ = Clock::now();

    std::mutex mutex_;  // guards the members below
    std::string stage_;
    bool active_ = false;
    Clock::time_point stageStart_;
    uint64_t total_ = 0;
    size_t nextPlanned_ = 0;     // plan_[nextPlanned_ - 1] is the current stage if it was planned
    double currentCost_ = 0;     // of the current stage
    double plannedSeconds_ = 0;  // that planned stages took, and their costs
    double plannedCost_ = 0;
    std::vector<StageTime> stageTimes_;

    std::atomic<uint64_t> done_{0};
    std::atomic<int64_t> nextDraw_{0};  // clock ticks since start_
};

}  // namespace phat
