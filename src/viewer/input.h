#pragma once
// Mouse and keys over the picture.

#include "viewer/viewer_state.h"
#include "viewer/window.h"

namespace phat {

/// Actions that a frame's keys requested and that were not applied to the state at once.
struct Actions {
    bool saveImage = false;
    bool save = false;
    bool fullScreen = false;
};

/// Moves the camera, picks, undoes. `area`: the picture's x, y, width and height in the window, in pixels.
/// pre: between beginFrame and endFrame.
Actions handleInput(ViewerState& state, const std::vector<Window::KeyPress>& pressed, glm::ivec4 area);

struct KeyHelp {
    const char* keys;
    const char* does;
};
inline constexpr KeyHelp kKeyHelp[] = {
    {"Left or middle drag", "orbit"},
    {"Shift + drag", "pan"},
    {"Wheel", "zoom"},
    {"Right drag", "look around"},
    {"W A S D, E Q", "fly; Shift: faster"},
    {"Click", "select"},
    {"F", "frame the selection"},
    {"G, R, then X Y Z", "move, rotate"},
    {"Space", "play the animation"},
    {"L", "dynamic lighting"},
    {"Home", "reset the camera"},
    {"Ctrl+Z, Ctrl+Shift+Z", "undo, redo"},
    {"Ctrl+S", "save"},
    {"C", "split view"},
    {"P", "save the image"},
    {"Tab", "toggle the panels"},
    {"F11", "full screen"},
};

}  // namespace phat
