#pragma once

#include <memory>
#include <string>

namespace phat {

/// An OpenGL 4.5 core context without a window (EGL surfaceless or device platform), current on the thread
/// that made it. Throws GlError in one sentence when there is none.
class HeadlessContext {
  public:
    HeadlessContext();
    ~HeadlessContext();
    HeadlessContext(const HeadlessContext&) = delete;
    HeadlessContext& operator=(const HeadlessContext&) = delete;

    /// GL_RENDERER and GL_VERSION, and both in one.
    std::string gpuName() const;
    std::string versionName() const;
    std::string rendererName() const;

  private:
    struct Egl;
    std::unique_ptr<Egl> egl_;
};

/// Whether the driver of the current context draws on the CPU.
bool drawsInSoftware();

}  // namespace phat
