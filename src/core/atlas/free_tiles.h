#pragma once
// Room for further charts in an atlas that has some.

#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "core/base/math.h"

namespace phat {

/// Rectangles of tiles that have charts.
struct TakenTiles {
    uint32_t width = 0;                                         // of the atlas
    std::vector<std::pair<glm::uvec2, glm::uvec2>> rectangles;  // origin, size
};

/// Places rectangles of tiles beside others, in a strip of a width that is endless downwards.
class FreeTiles {
  public:
    /// pre: the rectangles lie within `width`.
    FreeTiles(uint32_t width, const TakenTiles& taken);

    /// The first free place by row, then by column. pre: size.x <= width.
    glm::uvec2 find(glm::uvec2 size);
    void take(glm::uvec2 origin, glm::uvec2 size);

  private:
    /// The column from which on a rectangle at (x, y) might be free; x itself if it is.
    uint32_t freeFrom(uint32_t x, uint32_t y, glm::uvec2 size) const;

    uint32_t width_;
    std::vector<uint8_t> taken_;                                // [y][x]; free below the last row
    std::map<std::pair<uint32_t, uint32_t>, glm::uvec2> last_;  // per size: nothing is free before
};

}  // namespace phat
