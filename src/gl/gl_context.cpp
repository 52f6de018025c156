#include "gl/gl_context.h"

#include <epoxy/egl.h>
#include <epoxy/gl.h>
#include <fmt/format.h>

#include <vector>

#include "gl/gl_error.h"

namespace phat {
namespace {

EGLDisplay initialized(EGLDisplay display) {
    if (display == EGL_NO_DISPLAY || !eglInitialize(display, nullptr, nullptr)) return EGL_NO_DISPLAY;
    return display;
}

// A real GPU's device platform first, so that a machine with both a GPU and Mesa's software renderer uses the
// GPU; then whatever works without a window.
std::vector<EGLDisplay> candidateDisplays() {
    std::vector<EGLDisplay> displays;
    if (epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_platform_device") &&
        epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_device_enumeration")) {
        EGLDeviceEXT devices[16];
        EGLint count = 0;
        if (eglQueryDevicesEXT(16, devices, &count)) {
            for (EGLint i = 0; i < count; ++i)
                displays.push_back(eglGetPlatformDisplayEXT(EGL_PLATFORM_DEVICE_EXT, devices[i], nullptr));
        }
    }
    if (epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_MESA_platform_surfaceless"))
        displays.push_back(
            eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr));
    displays.push_back(eglGetDisplay(EGL_DEFAULT_DISPLAY));
    return displays;
}

EGLContext createCoreContext(EGLDisplay display) {
    if (!eglBindAPI(EGL_OPENGL_API)) return EGL_NO_CONTEXT;
    EGLConfig config = EGL_NO_CONFIG_KHR;
    if (!epoxy_has_egl_extension(display, "EGL_KHR_no_config_context")) {
        const EGLint wanted[] = {EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_SURFACE_TYPE, EGL_PBUFFER_BIT,
                                 EGL_NONE};
        EGLint count = 0;
        if (!eglChooseConfig(display, wanted, &config, 1, &count) || count == 0) return EGL_NO_CONTEXT;
    }
    const EGLint attributes[] = {EGL_CONTEXT_MAJOR_VERSION,
                                 4,
                                 EGL_CONTEXT_MINOR_VERSION,
                                 5,
                                 EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                 EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                 EGL_NONE};
    const EGLContext context = eglCreateContext(display, config, EGL_NO_CONTEXT, attributes);
    if (context == EGL_NO_CONTEXT) return EGL_NO_CONTEXT;
    if (eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context)) return context;
    eglDestroyContext(display, context);
    return EGL_NO_CONTEXT;
}

}  // namespace

struct HeadlessContext::Egl {
    EGLDisplay display = EGL_NO_DISPLAY;
    EGLContext context = EGL_NO_CONTEXT;
};

HeadlessContext::HeadlessContext() : egl_(std::make_unique<Egl>()) {
    bool anyDisplay = false;
    for (EGLDisplay candidate : candidateDisplays()) {
        const EGLDisplay display = initialized(candidate);
        if (display == EGL_NO_DISPLAY) continue;
        anyDisplay = true;
        egl_->context = createCoreContext(display);
        if (egl_->context != EGL_NO_CONTEXT) {
            egl_->display = display;
            return;
        }
    }
    throw GlError(anyDisplay ? "the graphics driver offers no OpenGL 4.5 core context without a window"
                             : "no EGL display without a window (is a graphics driver or Mesa installed?)");
}

// The display stays initialised: it is shared by everything in the process that asks EGL for it.
HeadlessContext::~HeadlessContext() {
    eglMakeCurrent(egl_->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    eglDestroyContext(egl_->display, egl_->context);
}

std::string HeadlessContext::gpuName() const {
    return reinterpret_cast<const char*>(glGetString(GL_RENDERER));
}

std::string HeadlessContext::versionName() const {
    return reinterpret_cast<const char*>(glGetString(GL_VERSION));
}

std::string HeadlessContext::rendererName() const {
    return fmt::format("{}, OpenGL {}", gpuName(), versionName());
}

bool drawsInSoftware() {
    const std::string name = reinterpret_cast<const char*>(glGetString(GL_RENDERER));
    for (const char* driver : {"llvmpipe", "softpipe", "SwiftShader"})
        if (name.find(driver) != std::string::npos) return true;
    return false;
}

}  // namespace phat
