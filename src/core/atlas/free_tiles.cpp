#include "core/atlas/free_tiles.h"

#include <algorithm>
#include <cassert>

namespace phat {

FreeTiles::FreeTiles(uint32_t width, const TakenTiles& taken) : width_(width) {
    for (const auto& [origin, size] : taken.rectangles) take(origin, size);
}

uint32_t FreeTiles::freeFrom(uint32_t x, uint32_t y, glm::uvec2 size) const {
    uint32_t from = x;
    const uint32_t rows = uint32_t(taken_.size() / width_);
    for (uint32_t row = y; row < std::min(y + size.y, rows); ++row)
        for (uint32_t column = x + size.x; column-- > from;)
            if (taken_[size_t(row) * width_ + column]) {
                from = column + 1;
                break;
            }
    return from;
}

glm::uvec2 FreeTiles::find(glm::uvec2 size) {
    assert(size.x <= width_);
    glm::uvec2& last = last_[{size.x, size.y}];  // tiles are only ever taken: what was full stays so
    for (uint32_t x = last.x, y = last.y;; x = 0, ++y)
        while (x + size.x <= width_) {
            const uint32_t from = freeFrom(x, y, size);
            if (from == x) return last = {x, y};
            x = from;
        }
}

void FreeTiles::take(glm::uvec2 origin, glm::uvec2 size) {
    assert(origin.x + size.x <= width_);
    const size_t needed = size_t(origin.y + size.y) * width_;
    if (taken_.size() < needed) taken_.resize(needed, 0);
    for (uint32_t row = origin.y; row < origin.y + size.y; ++row)
        std::fill_n(taken_.begin() + std::ptrdiff_t(size_t(row) * width_ + origin.x), size.x, uint8_t(1));
}

}  // namespace phat
