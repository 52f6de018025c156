#include "core/bake/irradiance_level.h"

#include <algorithm>

#include "core/atlas/texel_neighbors.h"

namespace phat {
namespace {

glm::vec2 positionIn(const Atlas& atlas, uint32_t texel) {
    return glm::vec2(texel % atlas.sizeTexels.x, texel / atlas.sizeTexels.x);
}

// Those of a group's texels that receive light.
std::vector<uint32_t> receiversOf(const ReceiverTexels& texels, glm::uvec2 group, uint32_t step) {
    std::vector<uint32_t> found;
    for (uint32_t i = 0; i < step * step; ++i) {
        const glm::uvec2 texel = group * step + glm::uvec2(i % step, i / step);
        const size_t index = size_t(texel.y) * texels.atlas.sizeTexels.x + texel.x;
        if (texels.receives[index]) found.push_back(uint32_t(index));
    }
    return found;
}

// Of some texels, the one nearest the middle of those that are of the first one's piece. Nearest the group's
// middle would be nearer the border of a piece, where it is mostly darker.
uint32_t middleOfPiece(const ReceiverTexels& texels, const std::vector<uint32_t>& some) {
    std::vector<uint32_t> own;
    glm::vec2 sum(0);
    for (const uint32_t texel : some) {
        if (!lieTogether(texels.atlas, texels.points, some.front(), texel)) continue;
        own.push_back(texel);
        sum += positionIn(texels.atlas, texel);
    }
    const glm::vec2 middle = sum / float(own.size());
    const auto off = [&](uint32_t texel) {
        const glm::vec2 to = positionIn(texels.atlas, texel) - middle;
        return glm::dot(to, to);
    };
    return *std::min_element(own.begin(), own.end(), [&](uint32_t a, uint32_t b) { return off(a) < off(b); });
}

}  // namespace

uint32_t IrradianceLevel::nodeOf(const Atlas& atlas, const TexelPoints& points, uint32_t texelIndex) const {
    if (points.triangle[texelIndex] == kNoTriangle) return kNoNode;
    uint32_t own = node[groupOf(texelIndex, atlas.sizeTexels.x)];
    while (own != kNoNode && !lieTogether(atlas, points, texel[own], texelIndex)) own = next[own];
    return own;
}

IrradianceLevel makeLevel(const ReceiverTexels& texels, uint32_t step,
                          const std::function<bool(glm::uvec2 group)>& selects) {
    const Atlas& atlas = texels.atlas;
    IrradianceLevel level;
    level.step = step;
    level.size = atlas.sizeTexels / step;
    level.node.assign(size_t(level.size.x) * level.size.y, kNoNode);
    for (uint32_t y = 0; y < level.size.y; ++y)
        for (uint32_t x = 0; x < level.size.x; ++x) {
            std::vector<uint32_t> left = receiversOf(texels, {x, y}, step);
            if (left.empty() || !selects({x, y})) continue;
            level.node[size_t(y) * level.size.x + x] = uint32_t(level.texel.size());
            while (!left.empty()) {
                const uint32_t node = middleOfPiece(texels, left);
                level.texel.push_back(node);
                std::erase_if(left, [&](uint32_t texel) {
                    return texel == node || lieTogether(atlas, texels.points, node, texel);
                });
                level.next.push_back(left.empty() ? kNoNode : uint32_t(level.texel.size()));
            }
        }
    return level;
}

}  // namespace phat
