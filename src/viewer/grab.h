#pragma once
// Moving and turning the selected thing by hand: G or R, then the mouse or a number, as Blender has it.

#include <optional>
#include <string>

#include "viewer/window.h"

namespace phat {

struct ViewerState;

struct Grab {
    bool turns = false;
    uint32_t node = 0;
    glm::vec3 pivotWorld{0};  // as it stood at the beginning
    int axis = -1;            // of the world; -1: in the picture's plane
    std::string typed;        // metres or degrees in place of the mouse
    glm::vec2 mouseStart{0}, mouse{0};
    bool changed = false;  // there is an edit of it
};

/// Does nothing when nothing is selected.
void beginGrab(ViewerState& state, bool turns);
/// A key while it lasts.
void grabKey(ViewerState& state, const Window::KeyPress& press);
/// The mouse is at `mouse` in the picture.
void moveGrab(ViewerState& state, glm::vec2 mouse);
void endGrab(ViewerState& state, bool keep);

/// A description, such as "Move y 0.2 m".
std::string describe(const Grab& grab);
/// Where a world point is in the picture, pixels; none behind the eye.
std::optional<glm::vec2> placeInPicture(const ViewerState& state, glm::vec3 point);

}  // namespace phat
