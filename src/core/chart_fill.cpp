#include "core/chart_fill.h"

namespace phat {

void fillWithinCharts(std::vector<glm::vec3>& values, std::vector<uint8_t>& known, const Atlas& atlas,
                      uint32_t step) {
    const glm::ivec2 size(atlas.sizeTexels / step);
    const auto indexOf = [&](glm::ivec2 p) { return size_t(p.y) * size.x + p.x; };
    const auto chartOf = [&](glm::ivec2 p) { return atlas.chartAt(glm::uvec2(p) * step); };

    // The open list is walked ring by ring, so the cost is that of the holes, not of the atlas.
    std::vector<glm::ivec2> open;
    for (int y = 0; y < size.y; ++y)
        for (int x = 0; x < size.x; ++x)
            if (!known[indexOf({x, y})] && chartOf({x, y}) != kNoChart) open.emplace_back(x, y);

    while (!open.empty()) {
        std::vector<glm::ivec2> still;
        std::vector<std::pair<size_t, glm::vec3>> filled;
        for (const glm::ivec2 p : open) {
            glm::vec3 sum(0);
            float count = 0;
            for (int i = 0; i < 9; ++i) {
                const glm::ivec2 q = glm::clamp(p + glm::ivec2(i % 3 - 1, i / 3 - 1), glm::ivec2(0), size - 1);
                if (!known[indexOf(q)] || chartOf(q) != chartOf(p)) continue;
                sum += values[indexOf(q)];
                count += 1;
            }
            if (count > 0)
                filled.emplace_back(indexOf(p), sum / count);
            else
                still.push_back(p);
        }
        if (filled.empty()) return;
        for (const auto& [index, value] : filled) {
            values[index] = value;
            known[index] = 1;
        }
        open.swap(still);
    }
}

}  // namespace phat
