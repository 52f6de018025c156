#pragma once
// A window with an OpenGL 4.5 core context and Dear ImGui.

#include <functional>
#include <glm/glm.hpp>
#include <string>
#include <vector>

struct GLFWwindow;

namespace phat {

class Window {
  public:
    /// `uiScale` 0: the screen's. Throws GlError in one sentence where there is no display or no OpenGL 4.5.
    Window(const std::string& title, glm::ivec2 size, float uiScale);
    ~Window();
    Window(const Window&) = delete;
    Window& operator=(const Window&) = delete;

    bool closeRequested() const;
    /// Handles what happened; first sleeps until something does, but no longer than `waitSeconds`. Returns
    /// whether it woke before that.
    bool handleEvents(double waitSeconds);
    void beginFrame();
    /// Black, where no picture is drawn.
    void clear();
    /// Draws the panels over what is in the window and shows both.
    void endFrame();

    /// Pixels; 0 while the window is minimised.
    glm::ivec2 framebufferSize() const;
    bool isMinimised() const;
    float uiScale() const { return uiScale_; }
    /// It is made hidden: a file that cannot be read opens no window.
    void show();
    void setTitle(const std::string& title);
    void toggleFullScreen();
    void setClipboard(const std::string& text);
    /// Keys pressed since the last call, also those that were let go before a frame could see them.
    struct KeyPress {
        int key = 0;  // GLFW_KEY_...
        bool control = false, shift = false;
    };
    std::vector<KeyPress> takeKeyPresses();
    /// Files dropped on the window since the last call.
    std::vector<std::string> takeDroppedFiles();

    /// Ends a wait; from any thread.
    static void wake();

  private:
    /// Keys that were pressed and let go since the last frame, which took long, count as down for one frame.
    void holdShortPresses();
    void releaseHeld();

    GLFWwindow* window_ = nullptr;
    float uiScale_ = 1;
    std::vector<KeyPress> pressed_;
    std::vector<int> held_;  // GLFW_KEY_...
    std::vector<std::string> dropped_;
    glm::ivec4 windowedPlace_{0};  // x, y, width, height before full screen
};

}  // namespace phat
