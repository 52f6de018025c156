#pragma once
// The stored data of the texel under the mouse.

#include <optional>

#include "viewer/viewer_state.h"

namespace phat {

struct TexelUnderMouse {
    glm::uvec2 texel{0};
    uint32_t chart = 0;
    float texelMeters = 0;
    Phatexel phatexel;  // of the kind of light and the layer that are inspected
};

/// Nothing where no surface with texels is. pre: there is a document.
std::optional<TexelUnderMouse> texelUnderMouse(const ViewerState& state);

}  // namespace phat
