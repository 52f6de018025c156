#pragma once
// What the window shows and how: read by the drawing, changed by the panels and the mouse.

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "gl/renderer.h"
#include "viewer/document.h"
#include "viewer/navigation.h"

namespace phat {

/// What one side of the wipe shows.
enum class Source : uint8_t { phat, phatPyramid, direct, pathTracer };
inline constexpr std::array<const char*, 4> kSourceNames = {"phat", "phat-pyramid", "direct light only",
                                                            "path tracer"};

struct ViewSettings {
    Source left = Source::phat, right = Source::pathTracer;
    bool compare = false;
    float wipe = 0.5f;  // share of the width
    bool difference = false;
    Component component = Component::all;
    float exposureStops = 0;
    ToneMap toneMap = ToneMap::agx;
    bool panels = true;
};

struct ViewerState {
    std::unique_ptr<Document> document;
    std::unique_ptr<Renderer> renderer;  // once there is a bake
    Navigation navigation;
    int camera = 0;  // of the file, or -1: moved by hand
    std::optional<uint32_t> selectedSurface;
    ViewSettings view;
    bool editing = false;  // a slider is held
    bool draggingWipe = false;
    std::string message;  // the last error or notice, one sentence
    std::vector<std::string> recentFiles;
    bool fileChanged = false;  // on disk, since it was read
    /// Grows with every change that asks for a new picture.
    uint64_t version = 0;

    void touch() { ++version; }
};

/// Shows one of the file's cameras.
void showCamera(ViewerState& state, int index);

}  // namespace phat
