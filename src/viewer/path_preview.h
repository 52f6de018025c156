#pragma once
// The path tracer's picture of the current view, refined beside the window's own thread.

#include <condition_variable>
#include <exception>
#include <memory>
#include <optional>
#include <thread>

#include "core/render/picture.h"
#include "core/scene/posed_scene.h"
#include "viewer/background.h"

namespace phat {

class PathPreview {
  public:
    struct View {
        Camera camera;
        int width = 1, height = 1;
        Component component = Component::all;
        SharedSnapshot scene;
    };
    struct Refined {
        Image mean;  // linear radiance, row 0 on top
        int samplesPerPixel = 0;
    };

    /// Works on all cores but the window's. `wake` is called after each pass.
    explicit PathPreview(Wake wake);
    ~PathPreview();
    PathPreview(const PathPreview&) = delete;
    PathPreview& operator=(const PathPreview&) = delete;

    /// Begins anew with this view. Returns at once.
    void show(View view);
    /// Nothing to do until the next show().
    void pause();
    /// The newest image of the last requested view, once. Rethrows the exception of its tracing.
    std::optional<Refined> take();

    /// Refinement ends here.
    static constexpr int kMaxSamples = 4096;

  private:
    class Stop;
    void run();
    void refine(const View& view, uint64_t version);

    Wake wake_;
    std::mutex mutex_;
    std::condition_variable changed_;
    std::optional<View> wanted_;
    std::optional<Refined> ready_;
    std::exception_ptr failure_;
    std::atomic<uint64_t> version_ = 0;  // of the request
    bool quit_ = false;
    std::thread thread_;
};

}  // namespace phat
