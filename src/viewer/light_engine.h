#pragma once

#include <cstdint>

namespace phat {

/// Where the light is made that follows changes.
enum class LightEngine : uint8_t {
    automatic,  // on the GPU, unless OpenGL is drawn in software or there is glass
    cpu,
    gpu,
};

}  // namespace phat
