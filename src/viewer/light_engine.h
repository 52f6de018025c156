#pragma once

#include <cstdint>

namespace phat {

/// Where the light is made that follows changes.
enum class LightEngine : uint8_t {
    cpu,  // by the incremental baker: in the end a bake of what is shown
    gpu,  // by the renderer, with estimators of its own
};

}  // namespace phat
