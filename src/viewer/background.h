#pragma once
// Work beside the window's own thread.

#include <functional>
#include <mutex>
#include <string>

#include "core/base/progress.h"
#include "core/base/stopwatch.h"

namespace phat {

/// Called from a worker when there is something new to show; must be safe from any thread.
using Wake = std::function<void()>;

/// Progress that a window can read while the work goes on.
class SharedProgress : public Progress {
  public:
    explicit SharedProgress(Wake wake) : wake_(std::move(wake)) {}

    void begin(const char* stage, uint64_t total) override;
    void advance(uint64_t done) override;
    void end() override;
    bool stopRequested() const override { return stop_; }

    void requestStop() { stop_ = true; }

    struct Report {
        std::string stage;
        float fraction = 0;         // of the stage
        double elapsedSeconds = 0;  // since construction
    };
    Report report() const;

  private:
    Wake wake_;
    std::atomic<bool> stop_ = false;
    std::atomic<uint64_t> done_ = 0, total_ = 0;
    std::atomic<int64_t> lastWakeMs_ = 0;
    mutable std::mutex mutex_;
    std::string stage_;
    const Stopwatch start_;
};

}  // namespace phat
