#pragma once
// Sizes in pixels as flags.

#include <CLI/CLI.hpp>
#include <glm/glm.hpp>

namespace phat {

inline constexpr int kMaxPictureSide = 16384;

/// WxH. Throws CLI::ValidationError unless both are from 1 to kMaxPictureSide.
glm::ivec2 parseSize(const CLI::Option* option);

}  // namespace phat
