#include "core/atlas/atlas.h"

namespace phat {

std::vector<BlockRect> blockRects(const Atlas& atlas) {
    std::vector<BlockRect> rects(atlas.blockCount);
    for (const Chart& chart : atlas.charts) {
        for (uint32_t y = 0; y < chart.blocksHigh(); ++y)
            for (uint32_t x = 0; x < chart.blocksWide(); ++x) {
                const glm::uvec2 offset = glm::uvec2(x, y) * kBlockSize;
                rects[chart.firstBlock + y * chart.blocksWide() + x] = {
                    chart.originTexel() + offset,
                    glm::min(glm::uvec2(kBlockSize), chart.sizeTexels() - offset)};
            }
    }
    return rects;
}

void numberBlocks(Atlas& atlas) {
    atlas.blockCount = 0;
    for (Chart& chart : atlas.charts) {
        chart.firstBlock = atlas.blockCount;
        atlas.blockCount += chart.blocksWide() * chart.blocksHigh();
    }
}

}  // namespace phat
