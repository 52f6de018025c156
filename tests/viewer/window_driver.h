#pragma once
// phat view on a screen of its own (Xvfb), with hands (XTest) and eyes (XGetImage).

#include <sys/types.h>

#include <functional>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/base/image.h"
#include "support/temporary_folder.h"

struct _XDisplay;

namespace phat {

/// A virtual screen of 24 bits a pixel; throws std::runtime_error when it does not come up.
class VirtualScreen {
  public:
    explicit VirtualScreen(glm::ivec2 size);
    ~VirtualScreen();
    VirtualScreen(const VirtualScreen&) = delete;
    VirtualScreen& operator=(const VirtualScreen&) = delete;

    const std::string& name() const { return name_; }
    pid_t process() const { return process_; }

  private:
    pid_t process_ = -1;
    std::string name_;  // for DISPLAY
};

class WindowDriver {
  public:
    /// Runs `phat view` in a folder of its own; the window fills the screen. `variables`: NAME=VALUE of its
    /// environment.
    WindowDriver(glm::ivec2 size, std::vector<std::string> arguments,
                 const std::vector<std::string>& variables = {});
    ~WindowDriver();
    WindowDriver(const WindowDriver&) = delete;
    WindowDriver& operator=(const WindowDriver&) = delete;

    // Input. Positions are pixels from the upper left corner.
    void moveTo(glm::ivec2 pixel);
    void click(glm::ivec2 pixel, bool control = false);
    /// In several steps, as a hand does.
    void drag(glm::ivec2 from, glm::ivec2 to, int button = 1);
    void hold(int button, bool down);
    void wheel(int steps);
    /// An X keysym's name: "f", "Tab", "F11", "Return", with "ctrl+" before it.
    void key(const std::string& name);
    void type(const std::string& digits);

    // The panels' widgets by their labels, an item of an open list by LIST/ITEM. Each waits until the window
    // has drawn the widget and turns the wheel until it is in the window. Of equal labels it is the first
    // one.
    void clickWidget(const std::string& label, bool control = false);
    /// The pixel at a fraction of a slider, from 0 at its left end to 1.
    glm::ivec2 pixelOnWidget(const std::string& label, float fraction);

    /// What the window put there.
    std::string clipboard();

    /// Waits until the window and its screen have slept for a while, and throws after `seconds` without that.
    void settle(double seconds = 1200);
    /// Display values (sRGB, 0 to 1), row 0 on top.
    Image screenshot() const;
    /// Of the window's program, all its threads.
    double processorSeconds() const;
    size_t residentBytes() const;
    bool running();
    /// Asks the window to close; returns the exit code, -1 after a signal.
    int close();
    /// What the program wrote to its error output so far.
    std::string errors() const;

    /// Where it runs and leaves its pictures.
    const TemporaryFolder& folder() const { return folder_; }

  private:
    void wait(double seconds);
    static constexpr const char* kWidgetsFile = "widgets.json";
    /// Left, top, right, bottom.
    std::optional<glm::ivec4> areaOf(const std::string& label) const;

    glm::ivec2 size_;
    TemporaryFolder folder_;
    VirtualScreen screen_;
    _XDisplay* display_ = nullptr;
    unsigned long window_ = 0;
    pid_t process_ = -1;
    int status_ = 0;
};

/// Whether `condition` holds within ten minutes: a guard against hanging.
bool comesTrue(const std::function<bool()>& condition);

/// `path`, once the file is there: the window writes it after the key that asks for it, whole or not at all.
std::string savedFile(const std::string& path);

/// Expects that the window, at rest, takes less than a hundredth of a processor.
void expectSleep(const WindowDriver& window);

}  // namespace phat
