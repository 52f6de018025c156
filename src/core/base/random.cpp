#include "core/base/random.h"

namespace phat {
namespace {

uint32_t spread(uint32_t x) {
    x &= 0xffffu;
    x = (x | (x << 8)) & 0x00ff00ffu;
    x = (x | (x << 4)) & 0x0f0f0f0fu;
    x = (x | (x << 2)) & 0x33333333u;
    return (x | (x << 1)) & 0x55555555u;
}

uint32_t compact(uint32_t x) {
    x &= 0x55555555u;
    x = (x | (x >> 1)) & 0x33333333u;
    x = (x | (x >> 2)) & 0x0f0f0f0fu;
    x = (x | (x >> 4)) & 0x00ff00ffu;
    return (x | (x >> 8)) & 0xffffu;
}

}  // namespace

uint32_t morton(uint32_t x, uint32_t y) {
    return spread(x) | (spread(y) << 1);
}

glm::uvec2 mortonDecode(uint32_t code) {
    return {compact(code), compact(code >> 1)};
}

}  // namespace phat
