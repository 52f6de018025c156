#include "viewer/window_driver.h"

#include <X11/Xlib.h>
#include <X11/Xutil.h>
#include <X11/extensions/XTest.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <thread>

#include "core/base/stopwatch.h"

extern char** environ;

namespace phat {
namespace {

using Clock = std::chrono::steady_clock;

// Asleep for so many looks in a row, so far apart, means idle: the window draws the settled picture 150 ms
// after the last motion and then sleeps.
constexpr int kIdleLooks = 4;
constexpr double kLookSeconds = 0.1;

std::vector<char*> pointersTo(std::vector<std::string>& words) {
    std::vector<char*> pointers;
    for (std::string& word : words) pointers.push_back(word.data());
    pointers.push_back(nullptr);
    return pointers;
}

// Ends with the test, however that ends. `folder` empty: the test's own.
pid_t start(std::vector<std::string> words, std::vector<std::string> surroundings, const std::string& folder,
            const std::string& errors) {
    const std::vector<char*> arguments = pointersTo(words), variables = pointersTo(surroundings);
    const pid_t process = fork();
    if (process < 0) throw std::runtime_error("no more processes");
    if (process > 0) return process;
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    const int file = open(errors.c_str(), O_WRONLY | O_CREAT, 0644);
    if (file >= 0) dup2(file, STDERR_FILENO);
    if (folder.empty() || chdir(folder.c_str()) == 0)
        execvpe(arguments[0], arguments.data(), variables.data());
    _exit(127);
}

std::vector<std::string> ownVariables() {
    std::vector<std::string> variables;
    for (char** variable = environ; *variable; ++variable) variables.push_back(*variable);
    return variables;
}

void sleepFor(double seconds) {
    std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
}

// Fields of /proc/.../stat after the program's name, which may hold spaces.
std::vector<std::string> statOf(const std::filesystem::path& folder) {
    std::ifstream file(folder / "stat");
    std::stringstream text;
    text << file.rdbuf();
    const std::string line = text.str();
    std::istringstream rest(line.substr(std::min(line.rfind(')'), line.size() - 1) + 1));
    std::vector<std::string> fields;
    for (std::string field; rest >> field;) fields.push_back(field);
    return fields;
}

std::filesystem::path folderOf(pid_t process) {
    return std::filesystem::path("/proc") / std::to_string(process);
}

// Clock ticks in user and system mode.
uint64_t ticksOf(pid_t process) {
    const auto fields = statOf(folderOf(process));
    return fields.size() > 12 ? std::stoull(fields[11]) + std::stoull(fields[12]) : 0;
}

bool allThreadsSleep(pid_t process) {
    std::error_code gone;
    for (const auto& thread : std::filesystem::directory_iterator(folderOf(process) / "task", gone)) {
        const auto fields = statOf(thread.path());
        if (!fields.empty() && fields[0] != "S") return false;
    }
    return true;
}

}  // namespace

VirtualScreen::VirtualScreen(glm::ivec2 size) {
    int ends[2];
    if (pipe(ends) != 0) throw std::runtime_error("no pipe");
    process_ = start({"Xvfb", "-displayfd", std::to_string(ends[1]), "-screen", "0",
                      fmt::format("{}x{}x24", size.x, size.y), "-nolisten", "tcp", "-noreset"},
                     ownVariables(), "", "/dev/null");
    ::close(ends[1]);
    // It writes the number when it is ready, then a line feed.
    std::string number;
    for (char c = 0; read(ends[0], &c, 1) == 1 && c != '\n';) number += c;
    ::close(ends[0]);
    if (number.empty()) throw std::runtime_error("Xvfb (Debian package xvfb) does not start");
    name_ = ":" + number;
}

VirtualScreen::~VirtualScreen() {
    if (process_ <= 0) return;
    kill(process_, SIGTERM);
    waitpid(process_, nullptr, 0);
}

WindowDriver::WindowDriver(glm::ivec2 size, std::vector<std::string> arguments,
                           const std::vector<std::string>& variables)
    : size_(size), screen_(size) {
    std::vector<std::string> words = {PHAT_PROGRAM, "view", "--size", fmt::format("{}x{}", size.x, size.y)};
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::vector<std::string> surroundings = ownVariables();
    std::erase_if(surroundings, [](const std::string& v) {
        return v.rfind("DISPLAY=", 0) == 0 || v.rfind("XDG_STATE_HOME=", 0) == 0;
    });
    surroundings.push_back("DISPLAY=" + screen_.name());
    surroundings.push_back("XDG_STATE_HOME=" + folder_.path.string());
    surroundings.push_back("PHAT_WIDGETS=" + folder_.file(kWidgetsFile));
    surroundings.insert(surroundings.end(), variables.begin(), variables.end());
    process_ = start(words, surroundings, folder_.path.string(), folder_.file("errors"));
    display_ = XOpenDisplay(screen_.name().c_str());
    if (!display_) throw std::runtime_error("the virtual screen cannot be reached");

    // Windows may go between two questions about them.
    XSetErrorHandler([](Display*, XErrorEvent*) { return 0; });
    // Nothing else is on the screen: the window is the root's child of the right size.
    for (const auto end = Clock::now() + std::chrono::seconds(600); window_ == 0;) {
        Window root = 0, parent = 0, *children = nullptr;
        unsigned count = 0;
        XQueryTree(display_, DefaultRootWindow(display_), &root, &parent, &children, &count);
        for (unsigned i = 0; i < count; ++i) {
            XWindowAttributes attributes = {};
            XGetWindowAttributes(display_, children[i], &attributes);
            if (attributes.map_state == IsViewable && attributes.width == size.x) window_ = children[i];
        }
        if (children) XFree(children);
        if (!running()) throw std::runtime_error("phat view ended: " + errors());
        if (Clock::now() > end) throw std::runtime_error("no window appeared");
        sleepFor(0.05);
    }
    XMoveWindow(display_, window_, 0, 0);
    XSetInputFocus(display_, window_, RevertToPointerRoot, CurrentTime);
    XSync(display_, False);
}

WindowDriver::~WindowDriver() {
    if (running()) {
        kill(process_, SIGKILL);
        waitpid(process_, &status_, 0);
    }
    if (display_) XCloseDisplay(display_);
}

// Between two events, so that each finds a frame of its own.
void WindowDriver::wait(double seconds) {
    XSync(display_, False);
    sleepFor(seconds);
}

void WindowDriver::moveTo(glm::ivec2 pixel) {
    XTestFakeMotionEvent(display_, 0, pixel.x, pixel.y, 0);
    wait(0.05);
}

void WindowDriver::hold(int button, bool down) {
    XTestFakeButtonEvent(display_, unsigned(button), down, 0);
    wait(0.05);
}

void WindowDriver::click(glm::ivec2 pixel, bool control) {
    const KeyCode controlKey = XKeysymToKeycode(display_, XStringToKeysym("Control_L"));
    moveTo(pixel);
    if (control) XTestFakeKeyEvent(display_, controlKey, True, 0);
    if (control) wait(0.05);
    hold(1, true);
    hold(1, false);
    if (control) XTestFakeKeyEvent(display_, controlKey, False, 0);
    wait(0.05);
}

void WindowDriver::drag(glm::ivec2 from, glm::ivec2 to, int button) {
    constexpr int kSteps = 6;
    moveTo(from);
    hold(button, true);
    for (int i = 1; i <= kSteps; ++i) moveTo(from + (to - from) * i / kSteps);
    hold(button, false);
}

void WindowDriver::wheel(int steps) {
    for (int i = 0; i < std::abs(steps); ++i) {
        const unsigned button = steps > 0 ? 4 : 5;
        XTestFakeButtonEvent(display_, button, True, 0);
        XTestFakeButtonEvent(display_, button, False, 0);
        wait(0.05);
    }
}

void WindowDriver::key(const std::string& name) {
    std::vector<KeyCode> codes;
    std::istringstream words(name);
    for (std::string word; std::getline(words, word, '+');) {
        const std::string symbol = word == "ctrl" ? "Control_L" : word == "shift" ? "Shift_L" : word;
        codes.push_back(XKeysymToKeycode(display_, XStringToKeysym(symbol.c_str())));
        if (codes.back() == 0) throw std::runtime_error("no key " + word);
    }
    for (const KeyCode code : codes) XTestFakeKeyEvent(display_, code, True, 0);
    wait(0.05);
    for (size_t i = codes.size(); i-- > 0;) XTestFakeKeyEvent(display_, codes[i], False, 0);
    wait(0.05);
}

void WindowDriver::type(const std::string& digits) {
    for (const char c : digits) key(c == '.' ? "period" : std::string(1, c));
}

std::string WindowDriver::clipboard() {
    const Window mine = XCreateSimpleWindow(display_, DefaultRootWindow(display_), 0, 0, 1, 1, 0, 0, 0);
    const Atom text = XInternAtom(display_, "UTF8_STRING", False);
    XConvertSelection(display_, XInternAtom(display_, "CLIPBOARD", False), text, text, mine, CurrentTime);
    XEvent event = {};
    const auto end = Clock::now() + std::chrono::seconds(100);
    while (!XCheckTypedWindowEvent(display_, mine, SelectionNotify, &event)) {
        if (Clock::now() > end) throw std::runtime_error("nobody answers for the clipboard");
        wait(0.02);
    }
    Atom type = None;
    int format = 0;
    unsigned long count = 0, left = 0;
    unsigned char* bytes = nullptr;
    XGetWindowProperty(display_, mine, text, 0, 1 << 16, True, text, &type, &format, &count, &left, &bytes);
    std::string answer(reinterpret_cast<const char*>(bytes), bytes ? count : 0);
    if (bytes) XFree(bytes);
    XDestroyWindow(display_, mine);
    return answer;
}

void WindowDriver::settle(double seconds) {
    const auto end = Clock::now() + std::chrono::duration<double>(seconds);
    uint64_t before = ~0ull;
    for (int quiet = 0; quiet < kIdleLooks;) {
        sleepFor(kLookSeconds);
        if (!running()) throw std::runtime_error("phat view ended: " + errors());
        if (Clock::now() > end) throw std::runtime_error("the window does not come to rest");
        const uint64_t now = ticksOf(process_);
        const bool still = now == before && allThreadsSleep(process_) && allThreadsSleep(screen_.process());
        before = now;
        quiet = still ? quiet + 1 : 0;
    }
}

Image WindowDriver::screenshot() const {
    XImage* seen = XGetImage(display_, DefaultRootWindow(display_), 0, 0, unsigned(size_.x),
                             unsigned(size_.y), AllPlanes, ZPixmap);
    if (!seen) throw std::runtime_error("no screenshot");
    Image image(size_.x, size_.y);
    for (int y = 0; y < size_.y; ++y)
        for (int x = 0; x < size_.x; ++x) {
            const unsigned long pixel = XGetPixel(seen, x, y);
            image.at(x, y) =
                glm::vec3(float(pixel >> 16 & 255), float(pixel >> 8 & 255), float(pixel & 255)) / 255.0f;
        }
    XDestroyImage(seen);
    return image;
}

double WindowDriver::processorSeconds() const {
    return double(ticksOf(process_)) / double(sysconf(_SC_CLK_TCK));
}

size_t WindowDriver::residentBytes() const {
    std::ifstream file(folderOf(process_) / "statm");
    size_t total = 0, resident = 0;
    file >> total >> resident;
    return resident * size_t(sysconf(_SC_PAGESIZE));
}

bool WindowDriver::running() {
    if (process_ <= 0) return false;
    if (waitpid(process_, &status_, WNOHANG) == process_) process_ = -1;
    return process_ > 0;
}

int WindowDriver::close() {
    XEvent event = {};
    event.xclient.type = ClientMessage;
    event.xclient.window = window_;
    event.xclient.message_type = XInternAtom(display_, "WM_PROTOCOLS", False);
    event.xclient.format = 32;
    event.xclient.data.l[0] = long(XInternAtom(display_, "WM_DELETE_WINDOW", False));
    event.xclient.data.l[1] = CurrentTime;
    XSendEvent(display_, window_, False, NoEventMask, &event);
    XSync(display_, False);
    for (const auto end = Clock::now() + std::chrono::seconds(600); running();) {
        if (Clock::now() > end) throw std::runtime_error("the window does not close");
        sleepFor(0.05);
    }
    return WIFEXITED(status_) ? WEXITSTATUS(status_) : -1;
}

bool comesTrue(const std::function<bool()>& condition) {
    const auto end = Clock::now() + std::chrono::seconds(600);
    for (; !condition(); sleepFor(0.05))
        if (Clock::now() > end) return false;
    return true;
}

std::string savedFile(const std::string& path) {
    EXPECT_TRUE(comesTrue([&] { return std::filesystem::exists(path); })) << path;
    return path;
}

void expectSleep(const WindowDriver& window) {
    const Stopwatch watch;
    const double before = window.processorSeconds();
    sleepFor(3);
    EXPECT_LE(window.processorSeconds() - before, 0.01 * watch.seconds());
}

std::string WindowDriver::errors() const {
    const auto bytes = readBytes(folder_.file("errors"));
    return {bytes.begin(), bytes.end()};
}

}  // namespace phat
