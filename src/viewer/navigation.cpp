#include "viewer/navigation.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <glm/gtc/matrix_transform.hpp>

namespace phat {
namespace {

// The view may rise to 89 degrees: at 90 a turn about the vertical would be a roll.
const float kHighestSine = std::sin(glm::radians(89.0f));
// A step of the wheel goes a tenth of the way.
constexpr float kZoomPerStep = 0.9f;
constexpr float kNearestFocus = 1e-3f;  // units of length

glm::vec3 axis(const Navigation& n, int column) {
    return glm::vec3(n.camera.worldFromCamera[column]);
}

void place(Navigation& n, glm::vec3 eye) {
    n.camera.worldFromCamera[3] = glm::vec4(eye, 1);
}

// About the eye: right and up positive.
void turn(Navigation& n, glm::vec2 radians) {
    const glm::vec3 eye = eyeOf(n);
    const float rise = std::asin(std::clamp(-axis(n, 2).y, -1.0f, 1.0f));
    const float highest = std::max(std::asin(kHighestSine), std::abs(rise));
    const float pitch = std::clamp(rise + radians.y, -highest, highest) - rise;
    glm::mat4 turned = n.camera.worldFromCamera;
    turned[3] = glm::vec4(0, 0, 0, 1);
    turned = glm::rotate(glm::mat4(1), -radians.x, glm::vec3(0, 1, 0)) *
             glm::rotate(glm::mat4(1), pitch, glm::vec3(turned[0])) * turned;
    // Rounding must not build up over thousands of turns.
    const glm::vec3 back = glm::normalize(glm::vec3(turned[2]));
    const glm::vec3 right = glm::normalize(glm::cross(glm::vec3(turned[1]), back));
    n.camera.worldFromCamera = glm::mat4(glm::vec4(right, 0), glm::vec4(glm::cross(back, right), 0),
                                         glm::vec4(back, 0), glm::vec4(eye, 1));
}

// Metres that a pixel spans in the focus.
float metersPerPixel(const Navigation& n, float height) {
    const float span =
        n.camera.perspective ? 2 * n.focusMeters * std::tan(0.5f * n.camera.yfovRadians) : 2 * n.camera.ymag;
    return span / std::max(height, 1.0f);
}

}  // namespace

Navigation navigationOf(const Camera& camera, float focusMeters, float unitMeters) {
    return {camera, std::max(focusMeters, kNearestFocus * unitMeters), unitMeters};
}

glm::vec3 eyeOf(const Navigation& n) {
    return glm::vec3(n.camera.worldFromCamera[3]);
}

glm::vec3 focusOf(const Navigation& n) {
    return eyeOf(n) - n.focusMeters * axis(n, 2);
}

void orbit(Navigation& n, glm::vec2 pixels, float height) {
    const glm::vec3 focus = focusOf(n);
    look(n, pixels, height);
    place(n, focus + n.focusMeters * axis(n, 2));
}

void look(Navigation& n, glm::vec2 pixels, float height) {
    turn(n, glm::vec2(pixels.x, -pixels.y) * (glm::pi<float>() / std::max(height, 1.0f)));
}

void pan(Navigation& n, glm::vec2 pixels, float height) {
    const float scale = metersPerPixel(n, height);
    place(n, eyeOf(n) + scale * (pixels.y * axis(n, 1) - pixels.x * axis(n, 0)));
}

void zoom(Navigation& n, float steps) {
    const float factor = std::pow(kZoomPerStep, steps);
    if (!n.camera.perspective) {
        n.camera.ymag = std::max(n.camera.ymag * factor, kNearestFocus * n.unitMeters);
        return;
    }
    const glm::vec3 focus = focusOf(n);
    n.focusMeters = std::max(n.focusMeters * factor, kNearestFocus * n.unitMeters);
    place(n, focus + n.focusMeters * axis(n, 2));
}

void fly(Navigation& n, glm::vec3 meters) {
    place(n, eyeOf(n) + meters.x * axis(n, 0) + glm::vec3(0, meters.y, 0) + meters.z * axis(n, 2));
}

void frameBounds(Navigation& n, const Bounds& bounds, float aspect) {
    if (bounds.empty()) return;
    const float radius = std::max(0.5f * bounds.diagonal(), kNearestFocus * n.unitMeters);
    if (n.camera.perspective) {
        const float half = 0.5f * n.camera.yfovRadians;
        const float narrower = std::min(half, std::atan(std::tan(half) * std::max(aspect, 1e-3f)));
        n.focusMeters = radius / std::sin(narrower);
    } else {
        n.camera.ymag = radius / std::min(aspect, 1.0f);
        n.focusMeters = 2 * radius;
    }
    place(n, bounds.center() + n.focusMeters * axis(n, 2));
}

}  // namespace phat
