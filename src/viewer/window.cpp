#include "viewer/window.h"

#include <epoxy/gl.h>
// After epoxy, which replaces the system's OpenGL headers.
#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <utility>

#include "gl/gl_error.h"
#include "viewer/font.h"

namespace phat {
namespace {

std::string lastGlfwError() {
    const char* description = nullptr;
    glfwGetError(&description);
    return description ? description : "unknown reason";
}

constexpr float kFontPixels = 14;  // unscaled height of a line

// Frees what the constructor had before it threw.
struct GlfwLibrary {
    GlfwLibrary() {
        if (!glfwInit()) throw GlError(fmt::format("cannot open a window: {}", lastGlfwError()));
    }
    ~GlfwLibrary() {
        if (owned) glfwTerminate();
    }
    bool owned = true;
};

}  // namespace

Window::Window(const std::string& title, glm::ivec2 size, float uiScale) {
    GlfwLibrary library;
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 4);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 5);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    glfwWindowHint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);
    glfwWindowHint(GLFW_SCALE_TO_MONITOR, GLFW_TRUE);
    glfwWindowHint(GLFW_VISIBLE, GLFW_FALSE);
    // The pictures are drawn elsewhere.
    glfwWindowHint(GLFW_DEPTH_BITS, 0);
    glfwWindowHint(GLFW_STENCIL_BITS, 0);
    window_ = glfwCreateWindow(size.x, size.y, title.c_str(), nullptr, nullptr);
    if (!window_) throw GlError(fmt::format("cannot open a window with OpenGL 4.5: {}", lastGlfwError()));
    library.owned = false;
    glfwMakeContextCurrent(window_);
    glfwSwapInterval(1);
    glfwSetWindowUserPointer(window_, this);
    glfwSetDropCallback(window_, [](GLFWwindow* window, int count, const char** paths) {
        auto& dropped = static_cast<Window*>(glfwGetWindowUserPointer(window))->dropped_;
        dropped.insert(dropped.end(), paths, paths + count);
    });

    glfwSetKeyCallback(window_, [](GLFWwindow* window, int key, int, int action, int mods) {
        if (action != GLFW_PRESS) return;
        static_cast<Window*>(glfwGetWindowUserPointer(window))
            ->pressed_.push_back({key, (mods & GLFW_MOD_CONTROL) != 0, (mods & GLFW_MOD_SHIFT) != 0});
    });

    ImGui::CreateContext();
    ImGui::GetIO().IniFilename = nullptr;
    ImGui_ImplGlfw_InitForOpenGL(window_, true);
    ImGui_ImplOpenGL3_Init("#version 450 core");
    uiScale_ = uiScale;
    if (uiScale_ <= 0) glfwGetWindowContentScale(window_, &uiScale_, nullptr);
    uiScale_ = std::clamp(uiScale_, 0.5f, 4.0f);
    ImGui::StyleColorsDark();
    ImGui::GetStyle().ScaleAllSizes(uiScale_);
    addFont(kFontPixels * uiScale_);
}

Window::~Window() {
    ImGui_ImplOpenGL3_Shutdown();
    ImGui_ImplGlfw_Shutdown();
    ImGui::DestroyContext();
    glfwDestroyWindow(window_);
    glfwTerminate();
}

bool Window::closeRequested() const {
    return glfwWindowShouldClose(window_);
}

bool Window::handleEvents(double waitSeconds) {
    if (waitSeconds <= 0) {
        glfwPollEvents();
        return true;
    }
    const double start = glfwGetTime();
    glfwWaitEventsTimeout(waitSeconds);
    return glfwGetTime() - start < waitSeconds;
}

void Window::beginFrame() {
    ImGui_ImplOpenGL3_NewFrame();
    ImGui_ImplGlfw_NewFrame();
    holdShortPresses();
    ImGui::NewFrame();
}

// Dear ImGui before 1.87 sees only which keys are down when a frame begins.
void Window::holdShortPresses() {
    ImGuiIO& io = ImGui::GetIO();
    for (const KeyPress& press : pressed_) {
        if (press.key < 0 || io.KeysDown[press.key]) continue;
        io.KeysDown[press.key] = true;
        io.KeyCtrl |= press.control;
        io.KeyShift |= press.shift;
        held_.push_back(press.key);
    }
}

void Window::releaseHeld() {
    ImGuiIO& io = ImGui::GetIO();
    for (const int key : std::exchange(held_, {})) io.KeysDown[key] = false;
    io.KeyCtrl = io.KeysDown[GLFW_KEY_LEFT_CONTROL] || io.KeysDown[GLFW_KEY_RIGHT_CONTROL];
    io.KeyShift = io.KeysDown[GLFW_KEY_LEFT_SHIFT] || io.KeysDown[GLFW_KEY_RIGHT_SHIFT];
}

void Window::clear() {
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
    glClearColor(0, 0, 0, 1);
    glClear(GL_COLOR_BUFFER_BIT);
}

void Window::endFrame() {
    ImGui::Render();
    releaseHeld();
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
    const glm::ivec2 size = framebufferSize();
    glViewport(0, 0, size.x, size.y);
    ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
    glfwSwapBuffers(window_);
}

bool Window::isMinimised() const {
    return glfwGetWindowAttrib(window_, GLFW_ICONIFIED) == GLFW_TRUE;
}

glm::ivec2 Window::framebufferSize() const {
    glm::ivec2 size(0);
    glfwGetFramebufferSize(window_, &size.x, &size.y);
    return size;
}

void Window::show() {
    glfwShowWindow(window_);
}

void Window::setTitle(const std::string& title) {
    glfwSetWindowTitle(window_, title.c_str());
}

void Window::toggleFullScreen() {
    if (glfwGetWindowMonitor(window_)) {
        glfwSetWindowMonitor(window_, nullptr, windowedPlace_.x, windowedPlace_.y, windowedPlace_.z,
                             windowedPlace_.w, 0);
        return;
    }
    GLFWmonitor* monitor = glfwGetPrimaryMonitor();
    const GLFWvidmode* mode = monitor ? glfwGetVideoMode(monitor) : nullptr;
    if (!mode) return;
    glfwGetWindowPos(window_, &windowedPlace_.x, &windowedPlace_.y);
    glfwGetWindowSize(window_, &windowedPlace_.z, &windowedPlace_.w);
    glfwSetWindowMonitor(window_, monitor, 0, 0, mode->width, mode->height, mode->refreshRate);
}

void Window::setClipboard(const std::string& text) {
    glfwSetClipboardString(window_, text.c_str());
}

std::vector<Window::KeyPress> Window::takeKeyPresses() {
    return std::exchange(pressed_, {});
}

std::vector<std::string> Window::takeDroppedFiles() {
    return std::exchange(dropped_, {});
}

void Window::wake() {
    glfwPostEmptyEvent();
}

}  // namespace phat
