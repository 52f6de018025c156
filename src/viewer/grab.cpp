#include "viewer/grab.h"

#define GLFW_INCLUDE_NONE  // epoxy has the declarations
#include <GLFW/glfw3.h>
#include <fmt/format.h>

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "core/render/picture.h"
#include "viewer/viewer_state.h"

namespace phat {
namespace {

Ray rayAt(const ViewerState& state, glm::vec2 pixel) {
    return cameraRay(state.navigation.camera, state.pictureSize.x, state.pictureSize.y, pixel);
}

glm::vec3 axisOf(int axis) {
    glm::vec3 direction(0);
    direction[axis] = 1;
    return direction;
}

// Under the mouse, as far away as the pivot.
glm::vec3 inPlane(const ViewerState& state, glm::vec3 pivot, glm::vec2 pixel) {
    const Ray ray = rayAt(state, pixel);
    const glm::vec3 forward = -glm::vec3(state.navigation.camera.worldFromCamera[2]);
    return ray.origin +
           ray.direction * (glm::dot(pivot - ray.origin, forward) / glm::dot(ray.direction, forward));
}

// Metres from the pivot to where the axis comes nearest to the mouse's ray.
float alongAxis(const ViewerState& state, glm::vec3 pivot, glm::vec3 axis, glm::vec2 pixel) {
    const Ray ray = rayAt(state, pixel);
    const float cosine = glm::dot(axis, ray.direction), sineSquared = 1 - cosine * cosine;
    if (sineSquared < 1e-4f) return 0;  // seen from its end
    return glm::dot(ray.origin - pivot, axis - cosine * ray.direction) / sineSquared;
}

std::optional<float> typedAmount(const Grab& grab) {
    char* end = nullptr;
    const float amount = std::strtof(grab.typed.c_str(), &end);
    if (grab.typed.empty() || end == grab.typed.c_str() || !std::isfinite(amount)) return std::nullopt;
    return amount;
}

glm::vec3 metersOf(const ViewerState& state, const Grab& grab) {
    if (const auto amount = typedAmount(grab)) return *amount * axisOf(std::max(grab.axis, 0));
    if (grab.axis < 0)
        return inPlane(state, grab.pivotWorld, grab.mouse) - inPlane(state, grab.pivotWorld, grab.mouseStart);
    const glm::vec3 axis = axisOf(grab.axis);
    return axis * (alongAxis(state, grab.pivotWorld, axis, grab.mouse) -
                   alongAxis(state, grab.pivotWorld, axis, grab.mouseStart));
}

// The mouse's way around the pivot in the picture.
glm::mat4 turnOf(const ViewerState& state, const Grab& grab) {
    const glm::vec3 towardEye = glm::normalize(rayAt(state, grab.mouseStart).origin - grab.pivotWorld);
    const glm::vec3 axis = grab.axis < 0 ? towardEye : axisOf(grab.axis);
    float radians = 0;
    if (const auto amount = typedAmount(grab)) {
        radians = glm::radians(*amount);
    } else if (const auto center = placeInPicture(state, grab.pivotWorld)) {
        const glm::vec2 from = grab.mouseStart - *center, to = grab.mouse - *center;
        // The picture's y points down.
        radians = -std::atan2(from.x * to.y - from.y * to.x, glm::dot(from, to));
        if (glm::dot(axis, towardEye) < 0) radians = -radians;
    }
    return glm::translate(glm::mat4(1), grab.pivotWorld) * glm::rotate(glm::mat4(1), radians, axis) *
           glm::translate(glm::mat4(1), -grab.pivotWorld);
}

void applyGrab(ViewerState& state) {
    Grab& grab = *state.grab;
    EditHistory& edits = state.document->edits;
    // From where it stood: a change that goes on replaces the one before.
    if (grab.changed) edits.drop();
    SceneEdits next = edits.now();
    NodeMotion& motion = motionFor(next.motions, state.document->scene(), grab.node);
    const glm::mat4 above = motionAbove(state.document->scene().nodes, next.motions, grab.node);
    if (!grab.turns && above == glm::mat4(1)) {
        motion.meters += metersOf(state, grab);
    } else {
        const glm::mat4 step =
            grab.turns ? turnOf(state, grab) : glm::translate(glm::mat4(1), metersOf(state, grab));
        motion = motionOf(grab.node, motion.pivot, glm::inverse(above) * step * above * matrixOf(motion));
    }
    edits.change(std::move(next), false);
    grab.changed = true;
}

}  // namespace

void beginGrab(ViewerState& state, bool turns) {
    if (!state.selectedSurface) return;
    Grab grab;
    grab.turns = turns;
    grab.node = state.document->scene().surfaces[*state.selectedSurface].node;
    grab.pivotWorld = boundsOfNode(state.document->shown(), grab.node).center();
    // Without a mouse over the picture it begins in the middle.
    grab.mouse = grab.mouseStart = state.mouse.x < 0 ? 0.5f * glm::vec2(state.pictureSize) : state.mouse;
    state.grab = grab;
}

void grabKey(ViewerState& state, const Window::KeyPress& press) {
    Grab& grab = *state.grab;
    if (press.key == GLFW_KEY_ESCAPE) return endGrab(state, false);
    if (press.key == GLFW_KEY_ENTER || press.key == GLFW_KEY_KP_ENTER) return endGrab(state, true);
    if (press.key >= GLFW_KEY_X && press.key <= GLFW_KEY_Z) {
        const int axis = press.key - GLFW_KEY_X;
        grab.axis = grab.axis == axis ? -1 : axis;
    } else if (press.key >= GLFW_KEY_0 && press.key <= GLFW_KEY_9) {
        grab.typed += char('0' + press.key - GLFW_KEY_0);
    } else if (press.key >= GLFW_KEY_KP_0 && press.key <= GLFW_KEY_KP_9) {
        grab.typed += char('0' + press.key - GLFW_KEY_KP_0);
    } else if (press.key == GLFW_KEY_PERIOD || press.key == GLFW_KEY_KP_DECIMAL) {
        grab.typed += '.';
    } else if (press.key == GLFW_KEY_MINUS || press.key == GLFW_KEY_KP_SUBTRACT) {
        grab.typed = grab.typed.rfind('-', 0) == 0 ? grab.typed.substr(1) : "-" + grab.typed;
    } else if (press.key == GLFW_KEY_BACKSPACE && !grab.typed.empty()) {
        grab.typed.pop_back();
    } else {
        return;
    }
    applyGrab(state);
}

void moveGrab(ViewerState& state, glm::vec2 mouse) {
    Grab& grab = *state.grab;
    if (mouse == grab.mouse) return;
    grab.mouse = mouse;
    if (!typedAmount(grab)) applyGrab(state);
}

void endGrab(ViewerState& state, bool keep) {
    if (!keep && state.grab->changed) state.document->edits.drop();
    state.grab.reset();
}

std::string describe(const Grab& grab) {
    std::string words = grab.turns ? "Rotate" : "Move";
    if (grab.axis >= 0) words += fmt::format(" about {}", "xyz"[grab.axis]);
    if (!grab.turns && grab.axis >= 0) words = fmt::format("Move along {}", "xyz"[grab.axis]);
    if (!grab.typed.empty()) words += fmt::format(" by {} {}", grab.typed, grab.turns ? "degrees" : "m");
    return words + ".  X Y Z: axis; type a number; Enter or click: confirm; Esc: cancel";
}

std::optional<glm::vec2> placeInPicture(const ViewerState& state, glm::vec3 point) {
    const Camera& camera = state.navigation.camera;
    const glm::vec3 p = glm::inverse(camera.worldFromCamera) * glm::vec4(point, 1.0f);
    const float half = camera.perspective ? -p.z * std::tan(0.5f * camera.yfovRadians) : camera.ymag;
    if (half <= 0) return std::nullopt;
    const glm::vec2 size(state.pictureSize);
    return 0.5f * size + glm::vec2(p.x, -p.y) * (0.5f * size.y / half);
}

}  // namespace phat
