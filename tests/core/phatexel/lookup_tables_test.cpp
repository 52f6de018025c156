// The tables of the run-time lookup against what they were made from.

#include "core/phatexel/lookup_tables.h"

#include <gtest/gtest.h>

#include "core/bake/bake.h"
#include "core/base/random.h"
#include "core/base/sobol.h"
#include "core/phatexel/directions.h"
#include "support/scene_builder.h"

namespace phat::test {
namespace {

struct World {
    explicit World(Directions directions, int layers = 1) {
        addRoom(scene, lambert(0.5f), glm::vec3(2));
        addQuad(scene, emitter(glm::vec3(8)), {0.7f, 1.95f, 0.7f}, {0.6f, 0, 0}, {0, 0, 0.6f});
        settings.atlas.texelBudget = 30'000;
        settings.photons.count = 20'000;
        settings.pathsPerPhatexel = 1;
        settings.directions = directions;
        settings.layers = layers;
        baked = bake(scene, settings, silent);
        frames = blockFrames(baked.atlas, baked.points);
        patches = fitTilePatches(baked.atlas, baked.points, frames);
    }
    Scene scene;
    BakeSettings settings;
    SilentProgress silent;
    Bake baked;
    std::vector<Frame> frames;
    std::vector<TilePatch> patches;
};

// Every valid PHATexel looks into the cell that the layout says it holds, but for those that rounding moved
// over its border.
TEST(LookupTables, PermutationsTellWhereTexelsLook) {
    for (const Directions directions : {Directions::guided, Directions::uniform}) {
        const World world(directions, 2);
        const Atlas& atlas = world.baked.atlas;
        const Phatexture& phatexture = world.baked.phatexture;
        ASSERT_TRUE(canLookUp(phatexture.indirect, phatexture.indirectGuides));
        for (const PhatexelLayer& layer : phatexture.indirect) {
            ASSERT_EQ(layer.scrambles.size(), atlas.blockCount);
            size_t valid = 0, same = 0;
            for (uint32_t i = 0; i < atlas.texelCount(); ++i) {
                const glm::uvec2 xy(i % atlas.sizeTexels.x, i / atlas.sizeTexels.x);
                const Phatexel phatexel = unpackPhatexel(layer.texels[i], 1);
                if (!phatexel.valid) continue;
                const uint32_t block = atlas.blockAt(xy);
                const Guide& guide =
                    phatexture.indirectGuides[phatexture.indirectGuides.size() == 1 ? 0 : block];
                const glm::uvec2 inBlock = (xy - atlas.charts[atlas.chartAt(xy)].originTexel()) % kBlockSize;
                const glm::ivec2 cell(stratifiedSquare(inBlock, layer.scrambles[block], glm::vec2(0.5f)) *
                                      float(kBlockSize));
                const glm::ivec2 found(guideToSquare(guide, phatexel.directionBlock) * float(kBlockSize));
                ++valid;
                same += cell == found;
            }
            EXPECT_GT(valid, 1000u);
            EXPECT_GT(same, valid * 9 / 10);
        }
    }
}

TEST(LookupTables, PhotonsDirectionsCannotBeLookedUp) {
    const World world(Directions::photons);
    EXPECT_FALSE(canLookUp(world.baked.phatexture.indirect, world.baked.phatexture.indirectGuides));
    // The area lights' directions are guided all the same.
    EXPECT_EQ(world.baked.phatexture.probes.size(), world.patches.size());
}

TEST(LookupTables, WarpsAgreeWithTheGuides) {
    const World world(Directions::guided);
    Rng rng(5);
    const std::vector<Guide>& guides = world.baked.phatexture.indirectGuides;
    for (const Guide& guide : guides) {
        const InverseCdf inverseCdfs = inverseCdfOf(guide);
        for (int i = 0; i < 20; ++i) {
            const glm::vec3 direction = squareToHemisphere(rng.uniform2());
            const glm::vec2 scaled = hemisphereToSquare(direction) * float(kGuideSize);
            const glm::ivec2 cell = glm::clamp(glm::ivec2(scaled), 0, kGuideSize - 1);
            const InverseCdfCell cellCdf = inverseCdfs[size_t(cell.y * kGuideSize + cell.x)];
            const glm::vec2 within = scaled - glm::vec2(cell);
            const glm::vec2 square(glm::mix(float(cellCdf.uLow), float(cellCdf.uHigh), within.x) / 255,
                                   glm::mix(float(cellCdf.vLow), float(cellCdf.vHigh), within.y) / 255);
            const glm::vec2 exact = guideToSquare(guide, direction);
            // Either end of a cell is rounded to half a 255th.
            EXPECT_NEAR(square.x, exact.x, 0.5f / 255 + 1e-4f);
            EXPECT_NEAR(square.y, exact.y, 0.5f / 255 + 1e-4f);
        }
    }
}

// The middle of a cell is where its ray went: what is left is the rounding to levels.
TEST(LookupTables, ProbesTellTheDistance) {
    const World world(Directions::uniform);
    const RayScene rays(world.scene);
    const Atlas& atlas = world.baked.atlas;
    ASSERT_EQ(world.baked.phatexture.probes.size(), world.patches.size());
    int compared = 0;
    for (size_t tile = 0; tile < world.patches.size(); tile += 7) {
        const TilePatch& patch = world.patches[tile];
        if (patch.empty) continue;
        const glm::uvec2 texel =
            glm::uvec2(tile % atlas.sizeTiles().x, tile / atlas.sizeTiles().x) * kTileSize +
            glm::uvec2(patch.probeTexel % kTileSize, patch.probeTexel / kTileSize);
        const size_t index = size_t(texel.y) * atlas.sizeTexels.x + texel.x;
        ASSERT_TRUE(world.baked.points.valid(index));
        const DepthProbe& probe = world.baked.phatexture.probes[tile];
        const float octaves = std::log2(unpackDistance(std::min(4 * probe.high, 254u), 1) /
                                        unpackDistance(std::max(4 * probe.low, 1u), 1));
        for (uint32_t cell = 0; cell < probe.level.size(); cell += 5) {
            const glm::vec3 local = squareToHemisphere(
                (glm::vec2(cell % kProbeSize, cell / kProbeSize) + 0.5f) / float(kProbeSize));
            const Hit hit = rays.closestHit(
                rays.offsetOrigin(world.baked.points.position[index], world.baked.points.normal[index]),
                world.frames[atlas.blockAt(texel)].toWorld(local));
            ASSERT_TRUE(hit);
            const float told = probeDistance(probe, probe.level[cell], atlas.unitMeters);
            // Half a level, and half a code of packDistance.
            EXPECT_LE(std::abs(std::log2(told / hit.distance)), 0.5f * octaves / 14 + 0.5f * 0.0788f + 1e-3f);
            ++compared;
        }
    }
    EXPECT_GT(compared, 1000);
}

TEST(TilePatches, AreExactOnPlanes) {
    const World world(Directions::uniform);
    const Atlas& atlas = world.baked.atlas;
    int compared = 0;
    for (uint32_t y = 0; y < atlas.sizeTexels.y; ++y)
        for (uint32_t x = 0; x < atlas.sizeTexels.x; ++x) {
            const size_t texel = size_t(y) * atlas.sizeTexels.x + x;
            if (world.baked.points.state[texel] != TexelState::surface) continue;
            const glm::uvec2 tile = glm::uvec2(x, y) / kTileSize;
            const TilePatch& patch = world.patches[size_t(tile.y) * atlas.sizeTiles().x + tile.x];
            const glm::vec2 fromMiddle = glm::vec2(x % kTileSize, y % kTileSize) - 3.5f;
            const glm::vec3 position = patch.at(fromMiddle, world.frames[atlas.blockAt({x, y})].normal);
            const float texelMeters = atlas.charts[atlas.chartAt({x, y})].texelSizeMeters;
            ASSERT_LT(glm::distance(position, world.baked.points.position[texel]), 0.02f * texelMeters);
            EXPECT_EQ(patch.groupBits, 5u);
            ++compared;
        }
    EXPECT_GT(compared, 1000);
}

// A sphere of 40 texels' radius, given exactly: a patch must follow its own tile, and say that it does not
// follow the block's.
TEST(TilePatches, FollowTheirTileOnCurves) {
    constexpr float kRadius = 40;
    Atlas atlas;
    atlas.sizeTexels = glm::uvec2(kBlockSize);
    Chart chart;
    chart.sizeTiles = atlas.sizeTiles();
    chart.texelSizeMeters = 1;
    atlas.charts = {chart};
    atlas.tileChart.assign(16, 0);
    numberBlocks(atlas);
    TexelPoints points;
    points.sizeTexels = atlas.sizeTexels;
    points.state.assign(atlas.texelCount(), TexelState::surface);
    points.triangle.assign(atlas.texelCount(), 0);
    for (uint32_t i = 0; i < atlas.texelCount(); ++i) {
        // Distance from the middle becomes arc length.
        const glm::vec2 flat = glm::vec2(i % kBlockSize, i / kBlockSize) - 15.5f;
        const float arc = glm::length(flat) / kRadius;
        points.position.push_back(kRadius *
                                  glm::vec3(std::sin(arc) * glm::normalize(flat), std::cos(arc) - 1.0f));
    }
    const std::vector<TilePatch> patches = fitTilePatches(atlas, points, {Frame()});
    float worst = 0, worstPlane = 0;
    for (uint32_t i = 0; i < atlas.texelCount(); ++i) {
        const glm::uvec2 texel(i % kBlockSize, i / kBlockSize), tile = texel / kTileSize;
        const glm::vec2 fromMiddle = glm::vec2(texel % kTileSize) - 3.5f;
        TilePatch patch = patches[tile.y * 4 + tile.x];
        worst = std::max(worst, glm::distance(patch.at(fromMiddle, Frame().normal), points.position[i]));
        patch.bend = glm::vec3(0);
        worstPlane =
            std::max(worstPlane, glm::distance(patch.at(fromMiddle, Frame().normal), points.position[i]));
    }
    // A quarter of a texel is what the lookup does not notice; the sag at a tile's corner is .4.
    EXPECT_LT(worst, 0.25f);
    EXPECT_LT(worst, 0.5f * worstPlane);
    EXPECT_LT(patches[0].groupBits, 5u);
}

TEST(Sobol, EveryAlignedRunIsStratified) {
    for (uint32_t seed : {1u, 77u}) {
        for (uint32_t run = 0; run < 16; ++run) {
            for (int d = 0; d < 4; ++d) {
                std::array<int, 16> strata{};
                for (uint32_t i = 0; i < 16; ++i) {
                    const float x = sobol4(run * 16 + i, seed)[d];
                    ASSERT_GE(x, 0.0f);
                    ASSERT_LT(x, 1.0f);
                    ++strata[size_t(x * 16)];
                }
                for (int count : strata) EXPECT_EQ(count, 1) << "run " << run << " dimension " << d;
            }
        }
    }
}

TEST(Sobol, FirstTwoDimensionsFillEveryElementaryRectangle) {
    for (int wide = 0; wide <= 8; ++wide) {
        std::array<int, 256> cells{};
        for (uint32_t i = 0; i < 256; ++i) {
            const glm::vec4 p = sobol4(i, 3);
            ++cells[size_t(p.x * float(1 << wide)) * (256 >> wide) + size_t(p.y * float(256 >> wide))];
        }
        for (int count : cells) EXPECT_EQ(count, 1) << wide;
    }
}

}  // namespace
}  // namespace phat::test
