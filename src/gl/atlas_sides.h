#pragma once
// Both sides of a triangle in the atlas.

#include "core/atlas/atlas.h"

namespace phat {

/// The charts of a triangle's front and back, and where each side's texels are relative to
/// Atlas::triangleTexels.
struct AtlasSides {
    glm::uvec2 charts{kNoChart};
    glm::vec2 frontOffset{0};
    glm::vec2 backOffset{0};
};

AtlasSides atlasSidesOf(const Atlas& atlas, uint32_t triangle);

}  // namespace phat
