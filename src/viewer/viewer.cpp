#include "viewer/viewer.h"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "gl/gl_error.h"
#include "io/image/image_file.h"
#include "viewer/background_bake.h"
#include "viewer/input.h"
#include "viewer/light_follower.h"
#include "viewer/panels.h"
#include "viewer/recent_files.h"
#include "viewer/render_command_line.h"
#include "viewer/sentence.h"
#include "viewer/things_beside.h"
#include "viewer/widgets.h"
#include "viewer/window.h"

namespace phat {
namespace {

// Dear ImGui needs a second and third frame to settle after an event.
constexpr int kFramesAfterEvent = 3;
// How often a window at rest looks whether its file has changed.
constexpr double kLookAtFileSeconds = 1;
// `prefix` with the first number of which no file has any of the endings, so that nothing is overwritten.
template <class... Endings>
std::string freeName(const char* prefix, const Endings&... endings) {
    for (int i = 1;; ++i) {
        const std::string name = fmt::format("{}{:04}", prefix, i);
        if (!(std::filesystem::exists(name + endings) || ...)) return name;
    }
}

class Viewer {
  public:
    explicit Viewer(const ViewerOptions& options)
        : options_(options),
          window_("PHATextures", options.size, options.uiScale),
          widgets_(widgetsFile()),
          pictures_(options.shaderFolder, Window::wake),
          things_(options.things) {
        state_.frameBudgetSeconds = options.frameBudgetSeconds;
        state_.lightEngine = options.lightEngine;
        if (!options.path.empty()) open(options.path);
        window_.show();
    }

    void run() {
        bool idle = false;
        while (!window_.closeRequested()) {
            const bool sleeps = idle && framesLeft_ == 0;
            const bool woken = window_.handleEvents(sleeps ? kLookAtFileSeconds : 0);
            if (!noticeFileChange() && !woken) continue;
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
    void applyChanges();
    /// Whether the animation goes on.
    bool play();
    void fulfill(const PanelActions& panels, const Actions& keys);
    void saveImage();
    void save();
    void beginTurntable(int frames);
    bool turn();
    /// Whether it has changed since the last look.
    bool noticeFileChange();
    void useBake();
    Image drawWhole(const Camera& camera);
    Image displayed(const Image& picture) const;
    PanelInput panelInput() const;
    /// Where the picture is in the window: beside the panels. x, y (from the top left), width, height in
    /// pixels.
    glm::ivec4 pictureArea() const;
    glm::uvec2 pictureSize() const { return {pictureArea().z, pictureArea().w}; }

    ViewerOptions options_;
    Window window_;
    WidgetRecord widgets_;
    Pictures pictures_;
    ViewerState state_;
    std::unique_ptr<BackgroundBake> bake_;
    bool rendererIsNew_ = false;
    ThingsBeside things_;
    SharedSnapshot moved_;  // that the renderer was last given
    LightFollower light_;
    std::chrono::steady_clock::time_point lastFrame_{};
    int framesLeft_ = kFramesAfterEvent;

    struct Turntable {
        Navigation start;
        std::string folder;
        int frames = 0, done = 0;
    };
    std::optional<Turntable> turntable_;
};

void Viewer::open(const std::string& path) {
    const std::string variant = path == options_.path ? options_.variant : "";
    auto document = std::make_unique<Document>(path, options_.lighting, variant);
    const bool again = state_.document && state_.document->path == path;
    bake_.reset();
    light_.reset();
    state_.renderer.reset();
    moved_.reset();
    pictures_.reset();
    state_.grab.reset();
    state_.switchedOff.clear();
    state_.document = std::move(document);
    state_.selectedSurface.reset();
    state_.fileChanged = false;
    state_.message = noticeOf(*state_.document);
    // Reloading a file keeps the camera.
    if (!again) showFirstView(state_);
    state_.touch();
    rememberFile(path);
    state_.recentFiles = recentFiles();
    window_.setTitle(fmt::format("{} - PHATextures", std::filesystem::path(path).filename().string()));
    if (state_.document->hasBake)
        useBake();
    else
        bake_ = std::make_unique<BackgroundBake>(state_.document->scene(), BakeSettings(), Window::wake);
}

void Viewer::tryOpen(const std::string& path) {
    try {
        open(path);
    } catch (const std::exception& error) {
        state_.message = sentenceOf(error);
    }
}

void Viewer::useBake() {
    pictures_.takeNewBake();
    Document& d = *state_.document;
    d.forgetUpdatedLight();
    light_.reset();
    state_.renderer.reset();
    moved_.reset();
    state_.renderer = std::make_unique<Renderer>(
        RendererInput{d.scene(), d.baked.atlas, d.baked.points, d.baked.phatexture, d.bvh(), things_.in(d)},
        options_.shaderFolder);
    rendererIsNew_ = true;
    state_.touch();
}

void Viewer::takeBake() {
    if (!bake_) return;
    try {
        auto result = bake_->take();
        if (result) {
            state_.document->takeBake(std::move(result->bake), result->settings);
            useBake();
        }
        if (bake_->done()) bake_.reset();
    } catch (const std::exception& error) {
        state_.message = fmt::format("{}: {}", state_.document->path, sentenceOf(error));
        bake_.reset();
    }
}

bool Viewer::play() {
    const auto now = std::chrono::steady_clock::now();
    const double passed = std::chrono::duration<double>(now - std::exchange(lastFrame_, now)).count();
    if (!state_.document || !state_.document->playback.playing) return false;
    Playback& playback = state_.document->playback;
    const double length = double(state_.document->scene().animations[size_t(playback.animation)].seconds());
    if (length > 0) playback.seconds = std::fmod(playback.seconds + passed, length);
    return true;
}

void Viewer::applyChanges() {
    if (!state_.document) return;
    Document& document = *state_.document;
    Document::Changes changes = document.show();
    if (changes.any) state_.touch();
    if (!state_.renderer) return;
    if (std::exchange(rendererIsNew_, false)) changes = {true, document.isMoved()};
    if (changes.any) {
        const SceneEdits& edits = document.edits.now();
        if (changes.moved) {
            const BakedScene& baked = document.baked;
            moved_ = document.posed.snapshot();
            state_.renderer->moveScene(document.shown(), baked.atlas, baked.points, moved_->worldFromRest());
        }
        state_.renderer->setMaterials(edits.materials);
        state_.renderer->setLights(document.shown().lights);
        state_.renderer->turnEnvironment(edits.environmentColumns);
    }
    if (!bake_) light_.follow(state_, changes.any, !window_.isMinimised());
}

PanelInput Viewer::panelInput() const {
    PanelInput input{pictures_, {}, 0, {}, window_.uiScale(), turntable_.has_value()};
    input.light = light_.report();
    if (!bake_) return input;
    const auto report = bake_->report();
    input.bakeStatus =
        fmt::format("Baking, step {} of {}: {}, {:.0f} s", std::min(bake_->step(), BackgroundBake::kSteps),
                    BackgroundBake::kSteps, report.stage, report.elapsedSeconds);
    input.bakeFraction = report.fraction;
    return input;
}

// What `phat render` makes of the same command, rays included.
Image Viewer::drawWhole(const Camera& camera) {
    FrameSettings settings = frameSettings(state_, state_.view.left);
    const glm::uvec2 size = pictureSize();
    settings.width = int(size.x);
    settings.height = int(size.y);
    settings.camera = camera;
    settings.samplesPerPixel = kKeptSamples;
    std::optional<LiveReflections> reflections;
    const TracedReflections* traced =
        settings.method == Method::phat ? &reflections.emplace(*state_.document).within(0) : nullptr;
    PictureSum sum;
    drawFrame(*state_.renderer, settings, traced, sum);
    return readMean(sum);
}

// Views of data are colours already.
Image Viewer::displayed(const Image& picture) const {
    const bool light = state_.view.left != Source::phatexels || showsLight(state_.view.inspection.what);
    return light ? toneMap(picture, state_.view.toneMap, state_.view.exposureStops)
                 : toneMap(picture, ToneMap::linear, 0);
}

void Viewer::saveImage() {
    const std::string name = freeName("phat-", ".png", ".exr");
    const Image picture = drawWhole(state_.navigation.camera);
    writePng(name + ".png", displayed(picture));
    writeExr(name + ".exr", picture);
    state_.message = fmt::format("Saved as {0}.png and {0}.exr.", name);
}

void Viewer::save() {
    light_.waitUntilStarted();  // it reads what is moved while that is written
    const std::string out = state_.document->save();
    state_.message =
        fmt::format("Saved as {}{}.", out, state_.document->isMoved() ? "; what was moved is not" : "");
    rememberFile(out);
}

void Viewer::beginTurntable(int frames) {
    const std::string folder = freeName("turntable-", "");
    std::filesystem::create_directory(folder);
    turntable_ = Turntable{state_.navigation, folder, frames, 0};
}

// One picture a frame, so that the window stays alive.
bool Viewer::turn() {
    if (!turntable_) return false;
    Turntable& t = *turntable_;
    Navigation navigation = t.start;
    // A drag over the window's height is half a turn.
    orbit(navigation, {2.0f * float(t.done) / float(t.frames), 0}, 1);
    const Image picture = drawWhole(navigation.camera);
    ++t.done;
    writePng(fmt::format("{}/{:04}.png", t.folder, t.done), displayed(picture));
    state_.message = fmt::format("Turntable: {} of {} pictures in {}.", t.done, t.frames, t.folder);
    if (t.done == t.frames) turntable_.reset();
    return turntable_.has_value();
}

bool Viewer::noticeFileChange() {
    if (!state_.document) return false;
    std::error_code missing;
    const auto time = std::filesystem::last_write_time(state_.document->path, missing);
    const bool changed = !missing && time != state_.document->writeTime;
    return std::exchange(state_.fileChanged, changed) != changed;
}

void Viewer::fulfill(const PanelActions& panels, const Actions& keys) {
    try {
        if (keys.fullScreen) window_.toggleFullScreen();
        if (!panels.open.empty()) open(panels.open);
        if (panels.copyCommand) {
            window_.setClipboard(renderCommandLine(state_, glm::ivec2(pictureSize())));
            state_.message = !state_.document->isMoved()
                                 ? "The command is in the clipboard."
                                 : "The command is in the clipboard; it shows things at rest.";
        }
        if (!state_.renderer) return;
        if (panels.saveImage || keys.saveImage) saveImage();
        if (panels.save || keys.save) save();
        if (panels.stopTurntable) turntable_.reset();
        if (panels.turntableFrames > 0) beginTurntable(panels.turntableFrames);
    } catch (const std::exception& error) {
        state_.message = sentenceOf(error);
    }
}

glm::ivec4 Viewer::pictureArea() const {
    const glm::ivec2 size = glm::max(window_.framebufferSize(), glm::ivec2(1));
    const int left = state_.view.panels ? std::min(int(panelWidth(window_.uiScale())), size.x - 1) : 0;
    return {left, 0, size.x - left, size.y};
}

bool Viewer::frame() {
    for (const std::string& path : window_.takeDroppedFiles()) tryOpen(path);
    takeBake();
    window_.beginFrame();
    const glm::ivec4 area = pictureArea();
    const Actions keys = handleInput(state_, window_.takeKeyPresses(), area);
    const PanelActions actions = drawPanels(state_, panelInput());
    widgets_.write();
    fulfill(actions, keys);
    bool more = play();
    try {
        applyChanges();
        more |= turn() || light_.hasMore();
        if (state_.document)
            more |= pictures_.refine(state_, pictureSize(), std::chrono::steady_clock::now());
    } catch (const GlError& error) {  // such as out of video memory
        state_.message = error.what();
        state_.renderer.reset();
        light_.reset();
        turntable_.reset();
    } catch (const std::exception& error) {  // such as a disk that is full
        state_.message = sentenceOf(error);
        turntable_.reset();
    }
    window_.clear();
    pictures_.show(state_, pictureArea(), window_.framebufferSize().y);
    window_.endFrame();
    return more;
}

}  // namespace

void runViewer(const ViewerOptions& options) {
    Viewer(options).run();
}

}  // namespace phat
