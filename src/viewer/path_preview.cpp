#include "viewer/path_preview.h"

#include <tbb/task_arena.h>

#include <algorithm>

#include "core/render/path_tracer.h"

namespace phat {

// A pass is given up as soon as another view is wanted.
class PathPreview::Stop : public SilentProgress {
  public:
    Stop(const std::atomic<uint64_t>& version, uint64_t mine) : version_(version), mine_(mine) {}
    bool stopRequested() const override { return version_ != mine_; }

  private:
    const std::atomic<uint64_t>& version_;
    uint64_t mine_;
};

PathPreview::PathPreview(Wake wake) : wake_(std::move(wake)) {
    thread_ = std::thread([this] { run(); });
}

PathPreview::~PathPreview() {
    {
        const std::lock_guard lock(mutex_);
        quit_ = true;
        ++version_;
    }
    changed_.notify_all();
    thread_.join();
}

void PathPreview::show(View view) {
    {
        const std::lock_guard lock(mutex_);
        wanted_ = std::move(view);
        ready_.reset();
        ++version_;
    }
    changed_.notify_all();
}

void PathPreview::pause() {
    const std::lock_guard lock(mutex_);
    wanted_.reset();
    ready_.reset();
    ++version_;
}

std::optional<PathPreview::Refined> PathPreview::take() {
    const std::lock_guard lock(mutex_);
    if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
    return std::exchange(ready_, std::nullopt);
}

void PathPreview::run() {
    tbb::task_arena arena(std::max(1, tbb::this_task_arena::max_concurrency() - 1));
    while (true) {
        View view;
        uint64_t version = 0;
        {
            std::unique_lock lock(mutex_);
            changed_.wait(lock, [this] { return quit_ || wanted_; });
            if (quit_) return;
            view = std::move(*std::exchange(wanted_, std::nullopt));
            version = version_;
        }
        try {
            arena.execute([&] { refine(view, version); });
        } catch (const Interrupted&) {
        } catch (...) {  // such as out of memory
            {
                const std::lock_guard lock(mutex_);
                failure_ = std::current_exception();
            }
            wake_();
        }
    }
}

void PathPreview::refine(const View& view, uint64_t version) {
    Stop stop(version_, version);
    const LightSampler lights(view.scene->scene());
    const Integrator integrator = pathTracer(view.scene->rays(), lights, view.component);
    PictureSettings settings;
    settings.width = view.width;
    settings.height = view.height;
    settings.camera = view.camera;
    Refined refined;
    // Passes that double: the first picture is there soon, and later ones spend little on handing over.
    for (int samples = 1; refined.samplesPerPixel < kMaxSamples; samples = std::min(2 * samples, 64)) {
        settings.samplesPerPixel = samples;
        settings.seed = uint64_t(refined.samplesPerPixel) + 1;
        const TracedPicture pass = tracePicture(settings, integrator, stop);
        const float fraction = float(samples) / float(refined.samplesPerPixel + samples);
        if (refined.samplesPerPixel == 0)
            refined.mean = pass.mean;
        else
            for (size_t i = 0; i < pass.mean.pixels.size(); ++i)
                refined.mean.pixels[i] = glm::mix(refined.mean.pixels[i], pass.mean.pixels[i], fraction);
        refined.samplesPerPixel += samples;
        {
            const std::lock_guard lock(mutex_);
            if (version_ != version) return;
            ready_ = refined;
        }
        wake_();
    }
}

}  // namespace phat
