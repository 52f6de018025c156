#pragma once

#include <stdexcept>

namespace phat {

/// The machine lacks what the renderer requires: no OpenGL 4.5 core, a shader that does not compile, out of
/// video memory. One sentence; caught in main.
struct GlError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

}  // namespace phat
