// The tables of the run-time lookup against what they were made from.

#include "core/lookup_tables.h"

#include <gtest/gtest.h>

#include "core/bake.h"
#include "core/directions.h"
#include "core/random.h"
#include "core/sobol.h"
#include "scene_builder.h"

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
        tables = buildLookupTables(baked.phatexture.indirect, baked.phatexture.indirectGuides, baked.atlas,
                                   baked.points, frames, silent);
    }
    Scene scene;
    BakeSettings settings;
    SilentProgress silent;
    Bake baked;
    std::vector<Frame> frames;
    LookupTables tables;
};

// The bake's own numbers come back from the directions alone.
TEST(LookupTables, FindTheBakesPermutations) {
    for (const Directions directions : {Directions::guided, Directions::uniform}) {
        const World world(directions, 2);
        ASSERT_EQ(world.tables.scrambles.size(), 2u);
        for (uint64_t layer = 0; layer < 2; ++layer) {
            ASSERT_EQ(world.tables.scrambles[layer].size(), world.baked.atlas.blockCount);
            size_t same = 0;
            for (uint32_t block = 0; block < world.baked.atlas.blockCount; ++block)
                same += world.tables.scrambles[layer][block] ==
                        (hashOf(world.settings.seed, layer + 1, block) & 1023u);
            // A block without a valid PHATexel has nothing to tell.
            EXPECT_GE(same, world.baked.atlas.blockCount * 9 / 10);
        }
    }
}

TEST(LookupTables, AreEmptyWithoutTheInvertibleLayout) {
    EXPECT_TRUE(World(Directions::photons).tables.warps.empty());
}

TEST(LookupTables, WarpsAgreeWithTheGuides) {
    const World world(Directions::guided);
    Rng rng(5);
    for (size_t g = 0; g < world.tables.warps.size(); ++g) {
        for (int i = 0; i < 20; ++i) {
            const glm::vec3 direction = squareToHemisphere(rng.uniform2());
            const glm::vec2 scaled = hemisphereToSquare(direction) * float(kGuideSize);
            const glm::ivec2 cell = glm::clamp(glm::ivec2(scaled), 0, kGuideSize - 1);
            const WarpCell warp = world.tables.warps[g][cell.y * kGuideSize + cell.x];
            const glm::vec2 within = scaled - glm::vec2(cell);
            const glm::vec2 square(glm::mix(float(warp.uLow), float(warp.uHigh), within.x) / 255,
                                   glm::mix(float(warp.vLow), float(warp.vHigh), within.y) / 255);
            const glm::vec2 exact = guideToSquare(world.baked.phatexture.indirectGuides[g], direction);
            // Either end of a cell is rounded to half a 255th.
            EXPECT_NEAR(square.x, exact.x, 0.5f / 255 + 1e-4f);
            EXPECT_NEAR(square.y, exact.y, 0.5f / 255 + 1e-4f);
        }
    }
}

// In an empty room the distance along a direction is known.
TEST(LookupTables, ProbesTellTheDistance) {
    const World world(Directions::uniform);
    const RayScene rays(world.scene);
    Rng rng(6);
    int compared = 0, near = 0;
    for (uint32_t c = 0; c < world.baked.atlas.charts.size(); ++c) {
        const Chart& chart = world.baked.atlas.charts[c];
        const glm::uvec2 middle = chart.originTexel() + chart.sizeTexels() / 2u;
        const size_t texel = size_t(middle.y) * world.baked.atlas.sizeTexels.x + middle.x;
        if (!world.baked.points.valid(texel)) continue;
        const uint32_t block = world.baked.atlas.blockAt(middle);
        const glm::uvec2 place = (middle - chart.originTexel()) % kBlockSize / kProbeTexels;
        const DistanceProbe& probe =
            world.tables.probes[(size_t(block) * kProbesAlongBlock + place.y) * kProbesAlongBlock + place.x];
        for (int i = 0; i < 50; ++i) {
            const glm::vec3 local = squareToHemisphere(rng.uniform2());
            if (local.z < 0.2f) continue;
            const glm::ivec2 cell =
                glm::clamp(glm::ivec2(hemisphereToSquare(local) * float(kProbeSize)), 0, kProbeSize - 1);
            const float told = unpackDistance(probe[cell.y * kProbeSize + cell.x]);
            const Hit hit = rays.closestHit(
                offsetOrigin(world.baked.points.position[texel], world.baked.points.normal[texel]),
                world.frames[block].toWorld(local));
            ASSERT_TRUE(hit);
            ++compared;
            near += std::abs(told / hit.distance - 1) < 0.25f;
        }
    }
    ASSERT_GT(compared, 100);
    // Cells of 9 degrees and a map filled from 24 texels around: most of them, not all.
    EXPECT_GT(near, compared * 8 / 10);
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
