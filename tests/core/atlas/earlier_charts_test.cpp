// Charts that stay where they were.

#include "core/atlas/earlier_charts.h"

#include "atlas_checks.h"
#include "core/atlas/free_tiles.h"
#include "core/base/random.h"
#include "support/moving_room.h"

namespace phat::test {
namespace {

AtlasSettings settings() {
    AtlasSettings settings;
    settings.texelBudget = 20'000;
    settings.glossyDensity = 1;
    return settings;
}

std::vector<uint32_t> numbered(size_t count) {
    std::vector<uint32_t> numbers(count);
    for (uint32_t i = 0; i < count; ++i) numbers[i] = i;
    return numbers;
}

Atlas builtOn(const EarlierCharts& earlier, const Scene& scene, const std::vector<Sides>& sides,
              AtlasStats* stats = nullptr) {
    SilentProgress silent;
    return buildAtlasOn(earlier, RayScene(scene), sides, settings(), silent, stats);
}

Atlas built(const Scene& scene, const std::vector<Sides>& sides) {
    SilentProgress silent;
    return buildAtlas(RayScene(scene), sides, settings(), silent);
}

void expectSameChart(const Chart& a, const Chart& b) {
    EXPECT_EQ(a.originTile, b.originTile);
    EXPECT_EQ(a.sizeTiles, b.sizeTiles);
    EXPECT_EQ(a.texelSizeMeters, b.texelSizeMeters);
    EXPECT_EQ(a.back, b.back);
}

struct EarlierChartsTest : testing::Test {
    Scene scene = roomWithBox();
    std::vector<Sides> sides = std::vector<Sides>(scene.surfaces.size(), Sides::front);
    Atlas before = built(scene, sides);
    EarlierCharts all{before, scene.surfaces, numbered(scene.surfaces.size())};
};

TEST_F(EarlierChartsTest, NothingChanges) {
    AtlasStats stats;
    const Atlas atlas = builtOn(all, scene, sides, &stats);
    EXPECT_EQ(stats.keptCharts, before.charts.size());
    EXPECT_EQ(atlas.sizeTexels, before.sizeTexels);
    EXPECT_EQ(atlas.texelSizeMeters, before.texelSizeMeters);
    EXPECT_EQ(atlas.tileChart, before.tileChart);
    EXPECT_EQ(atlas.triangleChart, before.triangleChart);
    EXPECT_EQ(atlas.triangleTexels, before.triangleTexels);
    EXPECT_EQ(atlas.blockCount, before.blockCount);
}

TEST_F(EarlierChartsTest, AnotherSurfaceFindsRoomBesideTheOthers) {
    Scene more = scene;
    addQuad(more, lambert(0.5f), {0.5f, 0.2f, 0.5f}, {0.2f, 0, 0}, {0, 0.3f, 0});
    more.surfaces.back().node = 7;
    std::vector<Sides> moreSides = sides;
    moreSides.push_back(Sides::both);
    EarlierCharts earlier = all;
    earlier.earlierSurface.push_back(kNewSurface);
    AtlasStats stats;
    const Atlas atlas = builtOn(earlier, more, moreSides, &stats);
    expectSoundAtlas(more, atlas, settings());
    ASSERT_EQ(stats.keptCharts, before.charts.size());
    ASSERT_EQ(atlas.charts.size(), before.charts.size() + 2);
    for (size_t c = 0; c < before.charts.size(); ++c) expectSameChart(atlas.charts[c], before.charts[c]);
    const Chart& added = atlas.charts[before.charts.size()];
    EXPECT_EQ(added.otherSide, before.charts.size() + 1);
    EXPECT_EQ(added.surface, more.surfaces.size() - 1);
    // As fine as the room's, whose texels have one size but for the freedom to fill tiles.
    EXPECT_NEAR(added.texelSizeMeters / before.texelSizeMeters, 1, kFillFreedom * kFillFreedom - 1);
}

TEST_F(EarlierChartsTest, WhatIsGoneLeavesItsTiles) {
    // The first surface of the room is gone, and comes back as a new one.
    EarlierCharts earlier = all;
    earlier.earlierSurface[0] = kNewSurface;
    AtlasStats stats;
    const Atlas atlas = builtOn(earlier, scene, sides, &stats);
    expectSoundAtlas(scene, atlas, settings());
    EXPECT_LT(stats.keptCharts, before.charts.size());
    EXPECT_GT(stats.keptCharts, 0u);
    // Its own place is free again, and large enough but for the freedom.
    EXPECT_LE(atlas.sizeTexels.y, before.sizeTexels.y + kTileSize);
}

TEST_F(EarlierChartsTest, ASideThatIsLitNowAsksForANewChart) {
    std::vector<Sides> now = sides;
    now[2] = Sides::both;
    const std::vector<bool> kept = keptSurfaces(scene, now, all);
    EXPECT_FALSE(kept[2]);
    EXPECT_TRUE(kept[0]);
    expectSoundAtlas(scene, builtOn(all, scene, now), settings());
    // One that is dark now keeps its texels.
    const Atlas both = built(scene, now);
    const EarlierCharts ofBoth{both, scene.surfaces, all.earlierSurface};
    EXPECT_TRUE(keptSurfaces(scene, sides, ofBoth)[2]);
}

TEST_F(EarlierChartsTest, ASharedChartIsKeptWithAllItsSurfacesAlone) {
    // One chart of the two first surfaces.
    for (size_t t = 0; t < before.triangleChart.size(); ++t)
        if (before.triangleSurface[t] == 1) before.triangleChart[t] = before.triangleChart[0];
    ASSERT_EQ(before.triangleSurface[0], 0u);
    EXPECT_TRUE(keptSurfaces(scene, sides, all)[0]);
    EarlierCharts without = all;
    without.earlierSurface[1] = kNewSurface;
    EXPECT_FALSE(keptSurfaces(scene, sides, without)[0]);
    Scene apart = scene;
    apart.surfaces[1].node = 9;
    EXPECT_FALSE(keptSurfaces(apart, sides, all)[0]);
    EXPECT_TRUE(keptSurfaces(apart, sides, all)[2]);
}

// Against brute force.
TEST(FreeTilesTest, FindsTheFirstPlace) {
    constexpr uint32_t kWidth = 12, kHeight = 200;
    Rng rng(3);
    FreeTiles tiles(kWidth, {kWidth, {{{2, 0}, {3, 4}}, {{0, 5}, {12, 1}}}});
    std::vector<bool> taken(kWidth * kHeight, false);
    const auto fill = [&](glm::uvec2 origin, glm::uvec2 size) {
        for (uint32_t y = origin.y; y < origin.y + size.y; ++y)
            for (uint32_t x = origin.x; x < origin.x + size.x; ++x) taken[y * kWidth + x] = true;
    };
    fill({2, 0}, {3, 4});
    fill({0, 5}, {12, 1});
    const auto isFree = [&](glm::uvec2 origin, glm::uvec2 size) {
        for (uint32_t y = origin.y; y < origin.y + size.y; ++y)
            for (uint32_t x = origin.x; x < origin.x + size.x; ++x)
                if (taken[y * kWidth + x]) return false;
        return true;
    };
    for (int i = 0; i < 100; ++i) {
        const glm::uvec2 size(1 + rng.bits() % 5, 1 + rng.bits() % 4);
        glm::uvec2 expected(0);
        while (expected.x + size.x > kWidth || !isFree(expected, size))
            if (++expected.x == kWidth) expected = {0, expected.y + 1};
        const glm::uvec2 found = tiles.find(size);
        ASSERT_EQ(found, expected) << i;
        tiles.take(found, size);
        fill(found, size);
    }
}

}  // namespace
}  // namespace phat::test
