#pragma once
// The path tracer's picture of the current view, refined beside the window's own thread.

#include <condition_variable>
#include <exception>
#include <memory>
#include <optional>
#include <thread>

#include "core/render/picture.h"
#include "core/scene/rays.h"
#include "viewer/background.h"
#include "viewer/edit_history.h"

namespace phat {

class PathPreview {
  public:
    struct View {
        Camera camera;
        int width = 1, height = 1;
        Component component = Component::all;
        SceneEdits edits;
        std::vector<glm::mat4> worldFromRest;
    };
    struct Refined {
        Image mean;  // linear radiance, row 0 on top
        int samplesPerPixel = 0;
    };

    /// Works on a copy of the scene, which must outlive it, on all cores but the window's. `wake` is called
    /// after each pass.
    PathPreview(const Scene& scene, Wake wake);
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

    const Scene& rest_;
    Scene scene_;  // with the view's edits and motion
    SceneEdits applied_;
    std::vector<glm::mat4> worldFromRest_;
    RayScene rays_;  // of scene_, whose opacity no edit changes
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
