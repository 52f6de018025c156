#include "viewer/viewer.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <imgui.h>

#include <algorithm>

#include "io/image_file.h"
#include "io/material_edit.h"
#include "viewer/background_bake.h"
#include "viewer/input.h"
#include "viewer/panels.h"
#include "viewer/window.h"

namespace phat {
namespace {

// Dear ImGui needs a second and third frame to settle after an event.
constexpr int kFramesAfterEvent = 3;

class Viewer {
  public:
    explicit Viewer(const ViewerOptions& options)
        : options_(options),
          window_("PHATextures", options.size, options.uiScale),
          pictures_(options.shaderFolder, Window::wake) {
        if (!options.path.empty()) open(options.path);
    }

    void run() {
        bool idle = false;
        while (!window_.closeRequested()) {
            window_.handleEvents(idle && framesLeft_ == 0);
            framesLeft_ = idle ? kFramesAfterEvent : std::max(framesLeft_ - 1, 0);
            const bool more = frame();
            idle = !more && framesLeft_ == 0;
        }
    }

  private:
    bool frame();
    void open(const std::string& path);
    void tryOpen(const std::string& path);
    void takeBake();
    void applyEdits();
    void fulfill(const PanelWishes& panels, const Wishes& keys);
    void keepPicture();
    void useBake();
    PanelInput panelInput() const;
    glm::uvec2 pixels() const { return glm::uvec2(glm::max(window_.framebufferSize(), glm::ivec2(1))); }

    ViewerOptions options_;
    Window window_;
    Pictures pictures_;
    ViewerState state_;
    std::unique_ptr<BackgroundBake> bake_;
    uint64_t appliedRevision_ = 0;
    int framesLeft_ = kFramesAfterEvent;
};

void Viewer::open(const std::string& path) {
    auto document = std::make_unique<Document>(path, options_.environment);
    bake_.reset();
    state_.renderer.reset();
    pictures_.reset();
    state_.document = std::move(document);
    state_.selectedSurface.reset();
    appliedRevision_ = 0;
    showCamera(state_, 0);
    window_.setTitle(fmt::format("{} - PHATextures", std::filesystem::path(path).filename().string()));
    if (state_.document->hasBake)
        useBake();
    else
        bake_ = std::make_unique<BackgroundBake>(state_.document->scene(), BakeSettings(), Window::wake);
}

void Viewer::tryOpen(const std::string& path) {
    try {
        open(path);
        state_.message.clear();
    } catch (const std::exception& error) {
        state_.message = error.what();
    }
}

void Viewer::useBake() {
    const BakedScene& baked = state_.document->baked;
    state_.renderer.reset();
    state_.renderer = std::make_unique<Renderer>(
        RendererInput{baked.loaded.scene, baked.atlas, baked.points, baked.phatexture}, options_.shaderFolder);
    appliedRevision_ = ~0ull;
    state_.touch();
}

void Viewer::takeBake() {
    if (!bake_) return;
    try {
        auto result = bake_->take();
        if (result) {
            BakedScene& baked = state_.document->baked;
            baked.atlas = std::move(result->atlas);
            baked.points = std::move(result->points);
            baked.phatexture = std::move(result->phatexture);
            state_.document->hasBake = true;
            useBake();
        }
        if (bake_->done()) bake_.reset();
    } catch (const std::exception& error) {
        state_.message = fmt::format("{}: {}", state_.document->path, error.what());
        bake_.reset();
    }
}

void Viewer::applyEdits() {
    if (!state_.document || state_.document->edits.revision() == appliedRevision_) return;
    appliedRevision_ = state_.document->edits.revision();
    if (state_.renderer) {
        state_.renderer->setMaterials(state_.document->edits.now().materials);
        state_.renderer->setLights(state_.document->edits.now().lights);
    }
    state_.touch();
}

PanelInput Viewer::panelInput() const {
    PanelInput input{pictures_, {}, 0, window_.uiScale()};
    if (!bake_) return input;
    const auto report = bake_->report();
    input.bakeStatus =
        fmt::format("Baking, step {} of {}: {}, {:.0f} s", std::min(bake_->step(), BackgroundBake::kSteps),
                    BackgroundBake::kSteps, report.stage, report.elapsedSeconds);
    input.bakeShare = report.share;
    return input;
}

void Viewer::keepPicture() {
    // The first name that is free, so that nothing is overwritten.
    for (int i = 1; i < 10'000; ++i) {
        const std::string name = fmt::format("phat-{:04}", i);
        if (std::filesystem::exists(name + ".png") || std::filesystem::exists(name + ".exr")) continue;
        const glm::uvec2 size = pixels();
        FrameSettings settings;
        settings.width = int(size.x);
        settings.height = int(size.y);
        settings.camera = state_.navigation.camera;
        settings.component = state_.view.component;
        const Image picture = state_.renderer->render(settings);
        writePng(name + ".png", toneMap(picture, state_.view.toneMap, state_.view.exposureStops));
        writeExr(name + ".exr", picture);
        state_.message = fmt::format("kept as {0}.png and {0}.exr", name);
        return;
    }
}

void Viewer::fulfill(const PanelWishes& panels, const Wishes& keys) {
    try {
        if (keys.fullScreen) window_.toggleFullScreen();
        if ((panels.screenshot || keys.screenshot) && state_.renderer) keepPicture();
    } catch (const std::exception& error) {
        state_.message = error.what();
    }
}

bool Viewer::frame() {
    for (const std::string& path : window_.takeDroppedFiles()) tryOpen(path);
    takeBake();
    window_.beginFrame();
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    const Wishes keys = handleInput(state_, {size.x, size.y});
    const PanelWishes wishes = drawPanels(state_, panelInput());
    fulfill(wishes, keys);
    applyEdits();
    bool more = false;
    if (state_.document) {
        try {
            more = pictures_.refine(state_, pixels());
        } catch (const std::exception& error) {  // such as out of video memory
            state_.message = error.what();
            state_.renderer.reset();
        }
        pictures_.show(state_, pixels());
    }
    window_.endFrame();
    return more;
}

}  // namespace

void showCamera(ViewerState& state, int index) {
    const Scene& scene = state.document->scene();
    const Camera camera = scene.cameras.empty() ? defaultCamera(scene) : scene.cameras[size_t(index)];
    // What is in the middle of the view is orbited.
    uint64_t rays = 0;
    const Hit hit = visibleHit(state.document->rays, cameraRay(camera, 2, 2, {1, 1}), rays);
    state.navigation = navigationOf(camera, hit ? hit.distance : 0.5f * boundsOf(scene).diagonal());
    state.camera = index;
    state.touch();
}

void runViewer(const ViewerOptions& options) {
    Viewer(options).run();
}

}  // namespace phat
