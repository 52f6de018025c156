#pragma once
// The panels: what they change, they change in the state.

#include "core/dynamic/baker_thread.h"
#include "viewer/pictures.h"
#include "viewer/viewer_state.h"

namespace phat {

/// What the panels tell beside the state, and what they may ask for.
struct PanelInput {
    const Pictures& pictures;
    std::string bakeStatus;  // empty: no bake is running
    float bakeFraction = 0;
    std::optional<BakerThread::Report> light;  // once anything has been changed
    float uiScale = 1;
    bool turning = false;  // a turntable is being written
};

struct PanelActions {
    bool saveImage = false;
    bool copyCommand = false;
    bool save = false;
    int turntableFrames = 0;  // 0: none
    bool stopTurntable = false;
    std::string open;  // a file; empty: none
};

/// Pixels of a window's width that the panels take.
float panelWidth(float uiScale);

/// pre: between beginFrame and endFrame.
PanelActions drawPanels(ViewerState& state, const PanelInput& input);

}  // namespace phat
