#pragma once
// The sections of the panels, in the order in which they stand.

#include <array>

#include "viewer/panels.h"
#include "viewer/widgets.h"

namespace phat {

void panelText(const std::string& line);
void wrappedText(const std::string& line);
/// A name at the left edge and its value at the right one.
void valueRow(const std::string& name, const std::string& value);

/// A list to choose from; whether it was.
template <class Enum, size_t n>
bool choose(const char* label, Enum& value, const std::array<const char*, n>& names) {
    int index = int(value);
    if (!widgets::list(label, &index, names)) return false;
    value = Enum(index);
    return true;
}

// Of the view: view_panels.cpp.
void drawPicturePanel(ViewerState& state);
void drawComparePanel(ViewerState& state, const Pictures& pictures);
void drawPhatexelPanel(ViewerState& state, const Pictures& pictures);
void drawPerformancePanel(ViewerState& state, const Pictures& pictures);

// Of edits: edit_panels.cpp.
/// The edit goes on while a slider is held.
struct Edit {
    SceneEdits next;
    bool changed = false;
    void note(bool now) { changed |= now; }
};
void drawSelectionPanel(ViewerState& state, Edit& edit);
void drawLightsPanel(ViewerState& state, Edit& edit);
/// The flux, peak and polar curve of a lamp: photometry_panel.cpp. pre: it has photometry.
void drawPhotometry(const PunctualLight& light);
void drawMotionPanel(ViewerState& state, Edit& edit);

// Of updates of the light: motion_panels.cpp.
void drawLivePanel(ViewerState& state, const PanelInput& input);

}  // namespace phat
