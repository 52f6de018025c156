#pragma once
// A bake beside the window's own thread: coarse at first, then finer, each as soon as it is there.

#include <exception>
#include <optional>
#include <thread>

#include "core/bake/bake.h"
#include "viewer/background.h"

namespace phat {

class BackgroundBake {
  public:
    /// Texels of the steps: each costs about four times the one before, and the first takes a second or two.
    static constexpr uint64_t kTexelBudgets[] = {16'384, 65'536, 262'144, 1'048'576};

    /// `scene` must outlive it. `wake` is called after each step and when a progress bar should move.
    BackgroundBake(const Scene& scene, const BakeSettings& settings, Wake wake);
    /// Stops the bake.
    ~BackgroundBake();
    BackgroundBake(const BackgroundBake&) = delete;
    BackgroundBake& operator=(const BackgroundBake&) = delete;

    /// A step's result and the settings that it was made with.
    struct Result {
        Bake bake;
        BakeSettings settings;
    };
    /// The newest step's result, once. Rethrows the bake's exception.
    std::optional<Result> take();
    SharedProgress::Report report() const { return progress_.report(); }
    /// Counted from 1; kSteps + 1 when all are done.
    int step() const { return step_; }
    bool done() const { return step_ > kSteps; }

    static constexpr int kSteps = int(std::size(kTexelBudgets));

  private:
    SharedProgress progress_;
    Wake wake_;
    std::atomic<int> step_ = 1;
    std::mutex mutex_;
    std::optional<Result> ready_;
    std::exception_ptr failure_;
    std::thread thread_;
};

}  // namespace phat
