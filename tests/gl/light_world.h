#pragma once
// Worlds of quads whose light the GPU makes.

#include <vector>

#include "gl/traced_world.h"

namespace phat::test {

/// All blocks, with so many rounds behind them.
inline std::vector<BlockTurn> turnsOf(const Atlas& atlas, uint32_t rounds) {
    std::vector<BlockTurn> turns;
    for (uint32_t block = 0; block < atlas.blockCount; ++block) turns.push_back({block, rounds});
    return turns;
}

/// Of worlds of quads, with guides that differ from block to block.
struct LightWorld {
    explicit LightWorld(Scene scene, uint32_t tiles = 8)
        : world(worldOfQuads(std::move(scene), tiles)), bvh(buildSceneBvh(world.scene)) {
        fillWithLookups(world, 2, 0);
        blocks = turnsOf(world.atlas, 0);
    }
    RendererInput input() const { return {world.scene, world.atlas, world.points, world.phatexture, &bvh}; }
    LightRound round(uint32_t number, RayChoice directions = RayChoice::guided) {
        blocks = turnsOf(world.atlas, number);
        return {.blocks = blocks, .number = number, .directions = directions};
    }
    size_t texelNear(uint32_t surface, glm::vec3 position) const {
        size_t best = 0;
        float nearest = 1e30f;
        for (size_t texel = 0; texel < world.atlas.texelCount(); ++texel) {
            const glm::uvec2 xy(texel % world.atlas.sizeTexels.x, texel / world.atlas.sizeTexels.x);
            const float away = glm::distance(world.points.position[texel], position);
            if (world.atlas.chartAt(xy) != surface || away >= nearest) continue;
            nearest = away;
            best = texel;
        }
        return best;
    }

    HeadlessContext context;
    RendererWorld world;
    SceneBvh bvh;
    std::vector<BlockTurn> blocks;
};

/// Calls body(texel, world direction, PHATexel) for the valid PHATexels of a surface's own texels.
template <typename Body>
void forPhatexels(const LightWorld& gpu, const StoredLight& light, uint32_t surface, const Body& body) {
    const Atlas& atlas = gpu.world.atlas;
    const std::vector<Frame> frames = blockFrames(atlas, gpu.world.points);
    for (size_t texel = 0; texel < atlas.texelCount(); ++texel) {
        const glm::uvec2 xy(texel % atlas.sizeTexels.x, texel / atlas.sizeTexels.x);
        const Phatexel phatexel = unpackPhatexel(light.phatexels[0][texel], 1);
        if (atlas.chartAt(xy) == surface && gpu.world.points.state[texel] == TexelState::surface &&
            phatexel.valid)
            body(texel, frames[atlas.blockAt(xy)].toWorld(phatexel.directionBlock), phatexel);
    }
}

}  // namespace phat::test
