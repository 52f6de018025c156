#include "core/bake/irradiance_split.h"

#include "core/atlas/texel_neighbors.h"

namespace phat {
namespace {

// Between nodes s texels apart the irradiance is a plane to within some (s / distance)^2 / 8: 1 %, with as
// much again by the smoothing, where the harmonic mean distance of the hits is this many steps.
constexpr float kSplitBelowSteps = 6.0f;
// Nodes side by side of which one receives so many times the light of the other. Distances alone do not tell:
// beside a gap that a lamp fills with light, most of what a node sees is far away.
constexpr float kSplitContrast = 1.5f;

struct Splitter {
    const ReceiverTexels& texels;
    const IrradianceLevel& level;
    const IrradianceMap& map;

    bool differ(uint32_t a, uint32_t b) const {
        const float lightA = luminance(map[a]), lightB = luminance(map[b]);
        return std::max(lightA, lightB) > kSplitContrast * std::min(lightA, lightB) &&
               lieTogether(texels.atlas, texels.points, a, b);
    }

    /// Whether one of a group's nodes, or of the nodes of a group beside it, has a small harmonic mean
    /// distance, or one of the former differs much from one of the latter.
    bool splits(size_t group, size_t beside) const {
        for (uint32_t n = level.node[beside]; n != kNoNode; n = level.next[n]) {
            if (level.distanceTexels[n] < kSplitBelowSteps * float(level.step)) return true;
            for (uint32_t own = level.node[group]; own != kNoNode; own = level.next[own])
                if (differ(level.texel[own], level.texel[n])) return true;
        }
        return false;
    }
};

/// [y][x] of the level's groups.
std::vector<uint8_t> groupsToSplit(const Splitter& splitter) {
    const IrradianceLevel& level = splitter.level;
    const Atlas& atlas = splitter.texels.atlas;
    const glm::ivec2 size(level.size);
    std::vector<uint8_t> split(level.node.size(), 0);
    for (int y = 0; y < size.y; ++y)
        for (int x = 0; x < size.x; ++x) {
            const uint32_t chart = atlas.chartAt(glm::uvec2(x, y) * level.step);
            const size_t own = size_t(y) * size.x + x;
            for (int i = 0; i < 9 && chart != kNoChart && split[own] == 0; ++i) {
                const glm::ivec2 p =
                    glm::clamp(glm::ivec2(x, y) + glm::ivec2(i % 3 - 1, i / 3 - 1), glm::ivec2(0), size - 1);
                if (atlas.chartAt(glm::uvec2(p) * level.step) != chart) continue;
                if (splitter.splits(own, size_t(p.y) * size.x + p.x)) split[own] = 1;
            }
        }
    return split;
}

}  // namespace

IrradianceLevel finerLevel(const ReceiverTexels& texels, const IrradianceLevel& coarse, uint32_t step,
                           const IrradianceMap& map, const ChartSet& charts) {
    const std::vector<uint8_t> split = groupsToSplit({texels, coarse, map});
    const uint32_t ratio = coarse.step / step;
    return makeLevel(texels, step, [&](glm::uvec2 group) {
        const glm::uvec2 around = group / ratio;
        const size_t index = size_t(around.y) * coarse.size.x + around.x;
        return coarse.node[index] != kNoNode && split[index] != 0 &&
               hasChart(charts, texels.atlas.chartAt(group * step));
    });
}

}  // namespace phat
