#include "core/atlas/skyline.h"

#include <cassert>

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wall"
#pragma GCC diagnostic ignored "-Wextra"
#pragma GCC diagnostic ignored "-Wunused-function"
#define STB_RECT_PACK_IMPLEMENTATION
#define STBRP_STATIC
#include <stb_rect_pack.h>
#pragma GCC diagnostic pop

namespace phat {
namespace {

// Places what fits; returns whether all did.
bool pack(std::vector<stbrp_rect>& rects, glm::uvec2 strip, Skyline heuristic) {
    std::vector<stbrp_node> nodes(strip.x);
    stbrp_context context;
    stbrp_init_target(&context, int(strip.x), int(strip.y), nodes.data(), int(nodes.size()));
    stbrp_setup_heuristic(&context, heuristic == Skyline::bestFit ? STBRP_HEURISTIC_Skyline_BF_sortHeight
                                                                  : STBRP_HEURISTIC_Skyline_BL_sortHeight);
    return stbrp_pack_rects(&context, rects.data(), int(rects.size())) != 0;
}

std::vector<stbrp_rect> rectsOf(std::span<const glm::uvec2> sizes) {
    std::vector<stbrp_rect> rects(sizes.size());
    for (size_t i = 0; i < sizes.size(); ++i)
        rects[i] = {int(i), stbrp_coord(sizes[i].x), stbrp_coord(sizes[i].y), 0, 0, 0};
    return rects;
}

}  // namespace

std::optional<SkylinePacking> packSkyline(std::span<const glm::uvec2> sizes, glm::uvec2 strip,
                                          Skyline heuristic) {
    std::vector<stbrp_rect> rects = rectsOf(sizes);
    if (!pack(rects, strip, heuristic)) return {};
    SkylinePacking packing;
    packing.origin.resize(sizes.size());
    for (const stbrp_rect& rect : rects) {
        packing.origin[size_t(rect.id)] = {uint32_t(rect.x), uint32_t(rect.y)};
        packing.size = glm::max(packing.size, packing.origin[size_t(rect.id)] + sizes[size_t(rect.id)]);
    }
    return packing;
}

SkylinePages packSkylinePages(std::span<const glm::uvec2> sizes, glm::uvec2 page) {
    SkylinePages pages;
    pages.page.resize(sizes.size());
    pages.origin.resize(sizes.size());
    for (std::vector<stbrp_rect> rects = rectsOf(sizes); !rects.empty(); ++pages.count) {
        pack(rects, page, Skyline::bestFit);
        std::vector<stbrp_rect> left;
        for (const stbrp_rect& rect : rects) {
            if (!rect.was_packed) {
                left.push_back(rect);
                continue;
            }
            const size_t i = size_t(rect.id);
            pages.page[i] = pages.count;
            pages.origin[i] = {uint32_t(rect.x), uint32_t(rect.y)};
            pages.size = glm::max(pages.size, pages.origin[i] + sizes[i]);
        }
        assert(left.size() < rects.size());
        rects = std::move(left);
    }
    return pages;
}

}  // namespace phat
