#include "core/atlas/skyline.h"

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wall"
#pragma GCC diagnostic ignored "-Wextra"
#pragma GCC diagnostic ignored "-Wunused-function"
#define STB_RECT_PACK_IMPLEMENTATION
#define STBRP_STATIC
#include <stb_rect_pack.h>
#pragma GCC diagnostic pop

namespace phat {

std::optional<SkylinePacking> packSkyline(std::span<const glm::uvec2> sizes, glm::uvec2 strip,
                                          Skyline heuristic) {
    std::vector<stbrp_rect> rects(sizes.size());
    for (size_t i = 0; i < sizes.size(); ++i)
        rects[i] = {int(i), stbrp_coord(sizes[i].x), stbrp_coord(sizes[i].y), 0, 0, 0};
    std::vector<stbrp_node> nodes(strip.x);
    stbrp_context context;
    stbrp_init_target(&context, int(strip.x), int(strip.y), nodes.data(), int(nodes.size()));
    stbrp_setup_heuristic(&context, heuristic == Skyline::bestFit ? STBRP_HEURISTIC_Skyline_BF_sortHeight
                                                                  : STBRP_HEURISTIC_Skyline_BL_sortHeight);
    if (!stbrp_pack_rects(&context, rects.data(), int(rects.size()))) return {};
    SkylinePacking packing;
    packing.origin.resize(sizes.size());
    for (const stbrp_rect& rect : rects) {
        packing.origin[size_t(rect.id)] = {uint32_t(rect.x), uint32_t(rect.y)};
        packing.size = glm::max(packing.size, packing.origin[size_t(rect.id)] + sizes[size_t(rect.id)]);
    }
    return packing;
}

}  // namespace phat
