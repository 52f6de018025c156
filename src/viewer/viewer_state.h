#pragma once
// State of the window: read when drawing, changed by the panels and the mouse.

#include <array>
#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "gl/renderer.h"
#include "viewer/document.h"
#include "viewer/grab.h"
#include "viewer/light_engine.h"
#include "viewer/live_reflections.h"
#include "viewer/navigation.h"

namespace phat {

/// Samples a pixel of pictures that are written.
inline constexpr int kKeptSamples = 16;

/// The source of one side of the wipe.
enum class Source : uint8_t { phat, phatPyramid, phatPaper, direct, pathTracer, phatexels };
inline constexpr std::array<const char*, 6> kSourceNames = {
    "phat", "phat-pyramid", "phat-paper", "direct light only", "path tracer", "PHATexels"};

struct ViewSettings {
    Source left = Source::phat, right = Source::pathTracer;
    bool compare = false;
    float wipe = 0.5f;  // fraction of the width
    bool difference = false;
    Component component = Component::all;
    Inspection inspection{Inspected::radiance};  // of Source::phatexels
    bool traced = true;                          // of Source::phat: sharp reflections
    float exposureStops = 0;
    ToneMap toneMap = ToneMap::agx;
    bool panels = true;
    bool liveLight = true;  // follows what is changed
    bool refine = false;    // light of a scene at rest is made anew and averaged
};

struct ViewerState {
    std::unique_ptr<Document> document;
    std::unique_ptr<Renderer> renderer;  // once there is a bake
    Navigation navigation;
    int camera = 0;  // of the file, or -1: moved by hand
    std::optional<uint32_t> selectedSurface;
    glm::ivec2 pictureSize{1};
    glm::vec2 mouse{-1};  // in the picture, pixels; negative: not over it
    /// When a hand last moved the mouse or pressed something.
    std::chrono::steady_clock::time_point lastInput{};
    ViewSettings view;
    bool editing = false;  // a slider is held
    bool draggingWipe = false;
    std::optional<Grab> grab;
    std::vector<std::optional<glm::vec3>> switchedOff;  // [light], its intensity before
    bool pressKeptGrab = false;  // the mouse's button that is still held selects nothing
    std::string message;         // the last error or notice, one sentence, until the next key or click
    std::vector<std::string> recentFiles;
    double frameBudgetSeconds = 0.008;  // see ViewerOptions
    LightEngine lightEngine = LightEngine::cpu;
    bool fileChanged = false;  // on disk, since it was read
    /// Grows with every change that requires a new image.
    uint64_t version = 0;
    /// Grows when nothing but the light on things is newer.
    uint64_t lightVersion = 0;
    /// The number of refinement passes of the displayed light.
    uint32_t refinements = 0;

    void touch() { ++version; }
};

/// Shows one of the file's cameras.
void showCamera(ViewerState& state, int index);

/// Shows a file that was opened: its first camera, exposed for what it sees.
void showFirstView(ViewerState& state);

/// What was added to a file's light; empty if nothing was.
std::string noticeOf(const Document& document);

/// Sets the exposure by what the view shows.
void meterExposure(ViewerState& state);

/// How the renderer draws what a side shows; the picture's size and its rays are the caller's. pre: not the
/// path tracer.
FrameSettings frameSettings(const ViewerState& state, Source source);

}  // namespace phat
