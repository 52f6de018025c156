#pragma once
// What TexelPoints take, for those who have to know before they are made.

#include "core/atlas/atlas.h"

namespace phat {

/// Bytes a texel of TexelPoints, and of the distance to the surface while they are made.
inline constexpr uint64_t kTexelPointBytes =
    sizeof(TexelState) + 3 * sizeof(glm::vec3) + sizeof(glm::vec2) + sizeof(uint32_t) + sizeof(float);

}  // namespace phat
