#pragma once
// Moving a camera by hand. The state is the camera itself, so a file's camera is shown as it is until it is
// moved.

#include "core/scene/scene.h"

namespace phat {

struct Navigation {
    Camera camera;
    float focusMeters = 1;  // from the eye to the centre of orbiting, along the view
    float unitMeters = 1;   // lengthUnit() of the scene
};

/// A camera of the file, or one of the viewer's: orbits what lies `focusMeters` ahead.
Navigation navigationOf(const Camera& camera, float focusMeters, float unitMeters);

glm::vec3 eyeOf(const Navigation& navigation);
glm::vec3 focusOf(const Navigation& navigation);

/// Mouse motion in pixels, right and down positive, in a window `height` pixels high. A drag over the
/// window's height turns by half a circle.
void orbit(Navigation& navigation, glm::vec2 pixels, float height);
/// Turns the head instead.
void look(Navigation& navigation, glm::vec2 pixels, float height);
/// The point in the focus stays under the mouse.
void pan(Navigation& navigation, glm::vec2 pixels, float height);
/// Steps of a mouse wheel, positive toward the focus. Never reaches it.
void zoom(Navigation& navigation, float steps);

/// Metres along the camera's right, world's up and the camera's backward.
void fly(Navigation& navigation, glm::vec3 meters);

/// Looks at the middle of `bounds` from where all of it is visible; the direction stays. `aspect`: width /
/// height.
void frameBounds(Navigation& navigation, const Bounds& bounds, float aspect);

}  // namespace phat
