#pragma once
// Rectangles onto a strip. A small door to stb_rect_pack.

#include <optional>
#include <span>
#include <vector>

#include "core/base/math.h"

namespace phat {

struct SkylinePacking {
    glm::uvec2 size{0};              // that the rectangles take of the strip
    std::vector<glm::uvec2> origin;  // per rectangle
};

enum class Skyline { bottomLeft, bestFit };

/// Places rectangles of these sizes, none over another, in a strip of this width; nothing if they are wider
/// or higher than the strip. They are not turned.
std::optional<SkylinePacking> packSkyline(std::span<const glm::uvec2> sizes, glm::uvec2 strip,
                                          Skyline heuristic);

struct SkylinePages {
    uint32_t count = 0;
    glm::uvec2 size{0};              // that the rectangles take of the fullest page in x and in y
    std::vector<uint32_t> page;      // per rectangle
    std::vector<glm::uvec2> origin;  // per rectangle
};

/// The same over as many pages as it takes. pre: no rectangle is larger than a page.
SkylinePages packSkylinePages(std::span<const glm::uvec2> sizes, glm::uvec2 page);

}  // namespace phat
