#include "viewer/input.h"

#include <GLFW/glfw3.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>

#include "core/render/picture.h"

namespace phat {
namespace {

// The diagonal of the scene in ten seconds; with Shift in two and a half.
constexpr float kDiagonalsPerSecond = 0.1f, kFaster = 4;
constexpr float kWipeReach = 8;  // unscaled pixels

Bounds boundsOf(const Scene& scene, const Surface& surface) {
    Bounds bounds;
    for (uint32_t i = 0; i < surface.triangleCount; ++i)
        for (int corner = 0; corner < 3; ++corner)
            bounds.add(scene.positions[scene.triangles[surface.firstTriangle + i][corner]]);
    return bounds;
}

std::optional<uint32_t> pick(const ViewerState& state, glm::vec2 pixel, glm::vec2 size) {
    const Ray ray = cameraRay(state.navigation.camera, int(size.x), int(size.y), pixel);
    uint64_t rays = 0;
    const Hit hit = visibleHit(state.document->rays(), ray, rays);
    if (!hit) return std::nullopt;
    return state.document->scene().triangleSurface[hit.triangle];
}

// Coordinates of Dear ImGui to pixels of the picture.
struct PixelMapping {
    glm::vec2 corner{0}, size{1}, scale{1};
    glm::vec2 operator()(ImVec2 p) const { return glm::vec2(p.x, p.y) * scale - corner; }
};

// Whether the mouse belongs to what is being moved.
bool handleGrab(ViewerState& state, glm::vec2 mouse) {
    if (!state.grab) return false;
    moveGrab(state, mouse);
    const bool keep = ImGui::IsMouseClicked(ImGuiMouseButton_Left);
    if (keep || ImGui::IsMouseClicked(ImGuiMouseButton_Right)) {
        endGrab(state, keep);
        state.pressKeptGrab = true;
    }
    return true;
}

void handleMouse(ViewerState& state, const PixelMapping& toPixels) {
    const ImGuiIO& io = ImGui::GetIO();
    if (ImGui::IsAnyMouseDown()) state.message.clear();
    if (handleGrab(state, toPixels(io.MousePos))) return;
    if (state.pressKeptGrab) {
        state.pressKeptGrab = ImGui::IsAnyMouseDown();
        return;
    }
    const glm::vec2 moved = glm::vec2(io.MouseDelta.x, io.MouseDelta.y) * toPixels.scale;
    const glm::vec2 mouse = toPixels(io.MousePos);
    Navigation& navigation = state.navigation;
    const Camera before = navigation.camera;
    const bool left = ImGui::IsMouseDragging(ImGuiMouseButton_Left);
    const bool middle = ImGui::IsMouseDragging(ImGuiMouseButton_Middle, 0);
    // The wipe's line is taken by the hand that comes near it.
    const float line = state.view.wipe * toPixels.size.x;
    if (ImGui::IsMouseClicked(ImGuiMouseButton_Left))
        state.draggingWipe = state.view.compare && !state.view.difference &&
                             std::abs(mouse.x - line) < kWipeReach * toPixels.scale.x;
    if (!ImGui::IsMouseDown(ImGuiMouseButton_Left))
        state.draggingWipe &= ImGui::IsMouseReleased(ImGuiMouseButton_Left);
    if (state.draggingWipe) {
        state.view.wipe = std::clamp(mouse.x / toPixels.size.x, 0.0f, 1.0f);
    } else if (left || middle) {
        if (io.KeyShift)
            pan(navigation, moved, toPixels.size.y);
        else
            orbit(navigation, moved, toPixels.size.y);
    } else if (ImGui::IsMouseDragging(ImGuiMouseButton_Right, 0)) {
        look(navigation, moved, toPixels.size.y);
    }
    if (io.MouseWheel != 0) zoom(navigation, io.MouseWheel);
    const ImVec2 dragged = ImGui::GetMouseDragDelta(ImGuiMouseButton_Left, 0);
    const bool still =
        dragged.x * dragged.x + dragged.y * dragged.y < io.MouseDragThreshold * io.MouseDragThreshold;
    if (ImGui::IsMouseReleased(ImGuiMouseButton_Left) && still && !state.draggingWipe)
        state.selectedSurface = pick(state, mouse, toPixels.size);
    if (navigation.camera.worldFromCamera != before.worldFromCamera ||
        navigation.camera.ymag != before.ymag) {
        state.camera = -1;
        state.touch();
    }
}

void handleFlight(ViewerState& state) {
    const ImGuiIO& io = ImGui::GetIO();
    if (io.KeyCtrl || state.grab) return;
    const auto axis = [](int forward, int backward) {
        return float(ImGui::IsKeyDown(forward)) - float(ImGui::IsKeyDown(backward));
    };
    const glm::vec3 direction(axis(GLFW_KEY_D, GLFW_KEY_A), axis(GLFW_KEY_E, GLFW_KEY_Q),
                              axis(GLFW_KEY_S, GLFW_KEY_W));
    if (direction == glm::vec3(0)) return;
    const float speed = kDiagonalsPerSecond * boundsOf(state.document->scene()).diagonal();
    // A frame that took long must not throw the eye through a wall.
    const float seconds = std::min(io.DeltaTime, 0.1f);
    fly(state.navigation, direction * (speed * seconds * (io.KeyShift ? kFaster : 1.0f)));
    state.camera = -1;
    state.touch();
}

void frameSelection(ViewerState& state, glm::vec2 size) {
    const Scene& scene = state.document->shown();
    const Bounds bounds =
        state.selectedSurface ? boundsOf(scene, scene.surfaces[*state.selectedSurface]) : boundsOf(scene);
    frameBounds(state.navigation, bounds, size.x / size.y);
    state.camera = -1;
    state.touch();
}

void play(ViewerState& state) {
    Playback& playback = state.document->playback;
    if (state.document->scene().animations.empty()) return;
    playback.animation = std::max(playback.animation, 0);
    playback.playing = !playback.playing;
}

void handleKey(ViewerState& state, const Window::KeyPress& press, glm::vec2 size, Actions& actions) {
    if (press.key == GLFW_KEY_TAB) state.view.panels = !state.view.panels;
    actions.fullScreen |= press.key == GLFW_KEY_F11;
    if (!state.document) return;
    if (state.grab) return grabKey(state, press);
    if (press.control) {
        EditHistory& edits = state.document->edits;
        if (press.key == GLFW_KEY_Y || (press.key == GLFW_KEY_Z && press.shift))
            edits.redo();
        else if (press.key == GLFW_KEY_Z)
            edits.undo();
        actions.save |= press.key == GLFW_KEY_S;
        return;
    }
    if (press.key == GLFW_KEY_F) frameSelection(state, size);
    if (press.key == GLFW_KEY_HOME) showCamera(state, 0);
    if (press.key == GLFW_KEY_ESCAPE) state.selectedSurface.reset();
    if (press.key == GLFW_KEY_G) beginGrab(state, false);
    if (press.key == GLFW_KEY_R) beginGrab(state, true);
    if (press.key == GLFW_KEY_SPACE) play(state);
    if (press.key == GLFW_KEY_L) {
        bool& wanted = press.shift ? state.view.refine : state.view.liveLight;
        wanted = !wanted;
    }
    if (press.key == GLFW_KEY_C) state.view.compare = !state.view.compare;
    actions.saveImage |= press.key == GLFW_KEY_P;
}

}  // namespace

Actions handleInput(ViewerState& state, const std::vector<Window::KeyPress>& pressed, glm::ivec4 area) {
    Actions actions;
    const ImGuiIO& io = ImGui::GetIO();
    const PixelMapping toPixels{glm::vec2(area.x, area.y),
                                glm::vec2(area.z, area.w),
                                {io.DisplayFramebufferScale.x, io.DisplayFramebufferScale.y}};
    if (!io.WantTextInput) {
        if (!pressed.empty()) state.message.clear();
        for (const Window::KeyPress& press : pressed) handleKey(state, press, toPixels.size, actions);
        if (state.document) handleFlight(state);
    }
    if (!pressed.empty() || io.MouseDelta.x != 0 || io.MouseDelta.y != 0 || io.MouseWheel != 0 ||
        ImGui::IsAnyMouseDown())
        state.lastInput = std::chrono::steady_clock::now();
    state.pictureSize = {area.z, area.w};
    state.mouse = io.WantCaptureMouse ? glm::vec2(-1) : toPixels(io.MousePos);
    if (!io.WantCaptureMouse && state.document) handleMouse(state, toPixels);
    return actions;
}

}  // namespace phat
