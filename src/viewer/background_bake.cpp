#include "viewer/background_bake.h"

#include <utility>

namespace phat {

BackgroundBake::BackgroundBake(const Scene& scene, const BakeSettings& settings, Wake wake)
    : progress_(wake), wake_(std::move(wake)) {
    thread_ = std::thread([this, &scene, wanted = settings] {
        try {
            for (const uint64_t budget : kTexelBudgets) {
                BakeSettings stepSettings = wanted;
                stepSettings.atlas.texelBudget = budget;
                Bake result = bake(scene, stepSettings, progress_);
                {
                    const std::lock_guard lock(mutex_);
                    ready_ = Result{std::move(result), stepSettings};
                    ++step_;
                }
                wake_();
            }
        } catch (const Interrupted&) {
        } catch (...) {
            const std::lock_guard lock(mutex_);
            failure_ = std::current_exception();
            step_ = kSteps + 1;
            wake_();
        }
    });
}

BackgroundBake::~BackgroundBake() {
    progress_.requestStop();
    thread_.join();
}

std::optional<BackgroundBake::Result> BackgroundBake::take() {
    const std::lock_guard lock(mutex_);
    if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
    return std::exchange(ready_, std::nullopt);
}

}  // namespace phat
