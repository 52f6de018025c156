#include "cli/progress_bar.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>

#include "cli/console.h"
#include "cli/interrupt.h"

namespace phat {
namespace {

using namespace std::chrono_literals;

constexpr std::chrono::steady_clock::duration kRedrawInterval = 100ms;
constexpr std::chrono::steady_clock::duration kLineInterval = 10s;
// Before this fraction of a stage, its own speed says less than that of the stages before it.
constexpr double kTrustedFraction = 0.02;
// Before this fraction of everything, nothing is known about the time that is left.
constexpr double kTrustedCostFraction = 0.005;
// With these, the longest line (hours elapsed, hours left) has 79 columns.
constexpr int kBarWidth = 20, kNameWidth = 19;

double secondsOf(std::chrono::steady_clock::duration duration) {
    return std::chrono::duration<double>(duration).count();
}

std::string clockTime(double seconds) {
    const auto whole = int64_t(seconds + 0.5);
    if (whole < 3600) return fmt::format("{}:{:02}", whole / 60, whole % 60);
    return fmt::format("{}:{:02}:{:02}", whole / 3600, whole / 60 % 60, whole % 60);
}

std::string shortCount(double count) {
    if (count >= 1e6) return fmt::format("{:.1f}M", count * 1e-6);
    if (count >= 1e3) return fmt::format("{:.1f}k", count * 1e-3);
    return fmt::format("{:.0f}", count);
}

size_t terminalWidth() {
    winsize size{};
    return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

}  // namespace

ProgressStyle progressStyle(bool quiet) {
    if (quiet) return ProgressStyle::none;
    return isatty(STDERR_FILENO) ? ProgressStyle::oneLine : ProgressStyle::lines;
}

ProgressBar::ProgressBar(ProgressStyle style, std::vector<PlannedStage> plan)
    : style_(style), plan_(std::move(plan)) {}

ProgressBar::~ProgressBar() {
    if (style_ != ProgressStyle::oneLine) return;
    tell("\r\x1b[K");
}

bool ProgressBar::stopRequested() const {
    return interruptRequested();
}

void ProgressBar::begin(const char* stage, uint64_t total) {
    const std::lock_guard lock(mutex_);
    stage_ = stage;
    total_ = total;
    active_ = true;
    stageStart_ = Clock::now();
    done_ = 0;
    currentCost_ = 0;
    const auto first = plan_.begin() + std::ptrdiff_t(nextPlanned_);
    const auto found = std::find_if(first, plan_.end(), [&](const auto& p) { return p.name == stage_; });
    if (found != plan_.end()) {  // what lies between was not needed
        nextPlanned_ = size_t(found - plan_.begin()) + 1;
        currentCost_ = found->cost;
    }
    const auto wait = style_ == ProgressStyle::oneLine ? 0ms : kLineInterval;
    nextDraw_ = (Clock::now() - start_ + wait).count();
}

void ProgressBar::advance(uint64_t done) {
    done_ += done;
    if (style_ == ProgressStyle::none) return;
    const auto now = Clock::now() - start_;
    int64_t due = nextDraw_;
    const auto interval = style_ == ProgressStyle::oneLine ? kRedrawInterval : kLineInterval;
    // One thread draws, the others go on working.
    if (now.count() < due || !nextDraw_.compare_exchange_strong(due, (now + interval).count())) return;
    const std::lock_guard lock(mutex_);
    if (active_) draw(false);
}

void ProgressBar::end() {
    const std::lock_guard lock(mutex_);
    if (!active_) return;
    draw(true);
    active_ = false;
    const double seconds = secondsOf(Clock::now() - stageStart_);
    const auto same = std::find_if(stageTimes_.begin(), stageTimes_.end(),
                                   [&](const StageTime& time) { return time.name == stage_; });
    if (same == stageTimes_.end())
        stageTimes_.push_back({stage_, seconds});
    else
        same->seconds += seconds;
    if (currentCost_ > 0) {
        plannedSeconds_ += seconds;
        plannedCost_ += currentCost_;
    }
}

// The current stage at its own speed; those to come at the speed, in seconds per unit of cost, of all so far.
std::optional<double> ProgressBar::secondsLeft(double stageSeconds, double stageFraction) const {
    double costToCome = 0;
    for (size_t i = nextPlanned_; i < plan_.size(); ++i) costToCome += plan_[i].cost;
    const double costDone = plannedCost_ + currentCost_ * stageFraction;
    const double wholeCost = plannedCost_ + currentCost_ + costToCome;
    if (!(costDone > kTrustedCostFraction * wholeCost)) return std::nullopt;
    const double secondsPerCost = (plannedSeconds_ + stageSeconds) / costDone;
    const double ofThisStage = stageFraction > kTrustedFraction
                                   ? stageSeconds / stageFraction * (1 - stageFraction)
                                   : secondsPerCost * currentCost_;
    return ofThisStage + secondsPerCost * costToCome;
}

void ProgressBar::draw(bool last) {
    if (style_ == ProgressStyle::none) return;
    const double stageSeconds = secondsOf(Clock::now() - stageStart_);
    const uint64_t done = last && !stopRequested() ? total_ : std::min<uint64_t>(done_, total_);
    const double fraction = total_ > 0 ? double(done) / double(total_) : 1.0;
    std::string times = clockTime(secondsOf(Clock::now() - start_));
    const auto left = secondsLeft(stageSeconds, fraction);
    if (left && !last) times += fmt::format(", about {} left", clockTime(*left));

    if (style_ == ProgressStyle::lines) {
        if (stageSeconds > 0) times += fmt::format(", {}/s", shortCount(double(done) / stageSeconds));
        tell(fmt::format("{}: {:.0f} %, {}\n", stage_, 100 * fraction, times));
    } else {
        const auto filled = size_t(kBarWidth * fraction);
        std::string line =
            fmt::format("{:<{}} [{}{}] {:3.0f} %  {}", stage_, kNameWidth, std::string(filled, '#'),
                        std::string(kBarWidth - filled, '-'), 100 * fraction, times);
        line.resize(std::min(line.size(), terminalWidth() - 1));
        tell(fmt::format("\r{}\x1b[K", line));  // erase what is left of a longer line
    }
}

}  // namespace phat
