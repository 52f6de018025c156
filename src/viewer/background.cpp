#include "viewer/background.h"

#include <algorithm>

namespace phat {
namespace {

// A bar that moves more often than this costs frames and shows no more.
constexpr int64_t kWakeEveryMs = 100;

}  // namespace

void SharedProgress::begin(const char* stage, uint64_t total) {
    {
        const std::lock_guard lock(mutex_);
        stage_ = stage;
    }
    done_ = 0;
    total_ = total;
    wake_();
}

void SharedProgress::advance(uint64_t done) {
    done_ += done;
    const int64_t now = int64_t(1e3 * start_.seconds());
    int64_t last = lastWakeMs_;
    if (now - last >= kWakeEveryMs && lastWakeMs_.compare_exchange_strong(last, now)) wake_();
}

void SharedProgress::end() {
    done_ = total_.load();
}

SharedProgress::Report SharedProgress::report() const {
    const std::lock_guard lock(mutex_);
    const uint64_t total = total_;
    return {stage_, total > 0 ? std::min(float(double(done_) / double(total)), 1.0f) : 0.0f,
            start_.seconds()};
}

}  // namespace phat
