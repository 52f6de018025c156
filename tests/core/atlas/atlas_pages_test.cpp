#include "core/atlas/atlas_pages.h"

#include <gtest/gtest.h>

#include <array>
#include <set>

#include "core/atlas/dilate.h"
#include "core/base/random.h"
#include "support/scene_builder.h"

namespace phat {
namespace {

// A room with a screen in it, whose sides both have texels.
struct World {
    explicit World(bool doubleSided = true) {
        test::addRoom(scene, test::lambert(0.5f), {3, 2, 4});
        Material screen = test::lambert(0.5f);
        screen.doubleSided = doubleSided;
        test::addQuad(scene, screen, {1, 0.2f, 1}, {1, 0, 0}, {0, 1, 0});
        const std::vector<uint32_t> components = connectedComponents(scene);
        std::vector<Sides> sides(components.back() + 1, Sides::front);
        sides[components.back()] = Sides::both;
        AtlasSettings settings;
        settings.texelSizeMeters = 0.05f;
        SilentProgress progress;
        atlas = buildAtlas(scene, sides, settings, progress);
    }

    Scene scene;
    Atlas atlas;
};

// Every texel says where it is.
std::vector<glm::vec3> places(const Atlas& atlas) {
    std::vector<glm::vec3> texels;
    for (uint32_t i = 0; i < atlas.texelCount(); ++i)
        texels.emplace_back(i % atlas.sizeTexels.x, i / atlas.sizeTexels.x, 1);
    return texels;
}

// What the middles of the triangles read in their pages are the texels that they have in the atlas.
void expectSameTexels(const World& world, const AtlasPages& pages) {
    const std::vector<glm::vec3> all = places(world.atlas);
    std::vector<std::vector<glm::vec3>> texels;
    for (uint32_t page = 0; page < pages.count; ++page)
        texels.push_back(texelsOfPage(all, world.atlas, pages, page));
    const auto parts = surfaceParts(world.scene, world.atlas, pages);
    ASSERT_EQ(parts.size(), world.scene.surfaces.size());
    size_t triangles = 0;
    for (const auto& surface : parts)
        for (const SurfacePart& part : surface)
            for (size_t t = 0; t < part.triangles.size(); ++t, ++triangles) {
                const auto& uvs = part.uvs[t];
                const glm::uvec2 at(glm::vec2(pages.sizeTexels) * (uvs[0] + uvs[1] + uvs[2]) / 3.0f);
                const glm::vec3 read = texels[part.page][size_t(at.y) * pages.sizeTexels.x + at.x];
                const uint32_t own = world.atlas.triangleChart[part.triangles[t]];
                const uint32_t chart = part.back ? world.atlas.charts[own].otherSide : own;
                const auto& corners = world.atlas.triangleTexels[part.triangles[t]];
                const glm::vec2 there = (corners[0] + corners[1] + corners[2]) / 3.0f -
                                        glm::vec2(world.atlas.charts[own].originTexel()) +
                                        glm::vec2(world.atlas.charts[chart].originTexel());
                ASSERT_EQ(read.z, 1) << "no chart lies there";
                const float half = 0.5f * float(pages.place[chart].coarser) + 0.001f;
                ASSERT_LE(std::abs(read.x + 0.5f - there.x), half);
                ASSERT_LE(std::abs(read.y + 0.5f - there.y), half);
            }
    EXPECT_EQ(triangles, world.scene.triangles.size() + 2);  // the screen has two on either side
}

TEST(AtlasPages, OnePageIsTheAtlasAsItIs) {
    const World world;
    const AtlasPages pages = pagesOf(world.atlas, 4096);
    EXPECT_EQ(pages.count, 1u);
    EXPECT_EQ(pages.sizeTexels, world.atlas.sizeTexels);
    expectSameTexels(world, pages);
}

TEST(AtlasPages, ChartsMoveIntoPagesWithTheirTexels) {
    const World world;
    const AtlasPages pages = pagesOf(world.atlas, 100);  // no multiple of a tile
    EXPECT_GT(pages.count, 2u);
    EXPECT_LE(std::max(pages.sizeTexels.x, pages.sizeTexels.y), 96u);
    std::set<std::array<uint32_t, 3>> tiles;
    size_t count = 0;
    for (size_t c = 0; c < world.atlas.charts.size(); ++c) {
        const glm::uvec2 size = world.atlas.charts[c].sizeTiles, origin = pages.place[c].originTile;
        EXPECT_LE(origin.x + size.x, pages.sizeTexels.x / kTileSize);
        EXPECT_LE(origin.y + size.y, pages.sizeTexels.y / kTileSize);
        for (uint32_t y = 0; y < size.y; ++y)
            for (uint32_t x = 0; x < size.x; ++x, ++count)
                tiles.insert({pages.place[c].page, origin.x + x, origin.y + y});
    }
    EXPECT_EQ(tiles.size(), count) << "charts overlap";
    expectSameTexels(world, pages);
}

// Their texels are the means of four: the place that they say is the middle of these.
TEST(AtlasPages, ChartsThatAreLargerThanAPageAreCoarser) {
    const World world;
    const AtlasPages pages = pagesOf(world.atlas, 64);
    size_t coarse = 0, plain = 0;
    for (const AtlasPages::Place& place : pages.place) {
        EXPECT_LE(place.coarser, 2u);
        coarse += place.coarser == 2;
        plain += place.coarser == 1;
    }
    EXPECT_GT(coarse, 0u);
    EXPECT_GT(plain, 0u);
    expectSameTexels(world, pages);
}

void expectFrontsAlone(const World& world, PartSides sides) {
    for (const auto& surface : surfaceParts(world.scene, world.atlas, pagesOf(world.atlas, 4096), sides)) {
        ASSERT_EQ(surface.size(), 1u);
        EXPECT_FALSE(surface[0].back);
        EXPECT_FALSE(surface[0].oneSided);
    }
}

TEST(AtlasPages, ASingleSidedSurfaceHasOnePart) {
    expectFrontsAlone(World(false), PartSides::both);
}

TEST(AtlasPages, FrontsAloneAreParts) {
    expectFrontsAlone(World(), PartSides::front);
}

TEST(AtlasPages, AreRefusedWhereAChartIsLarger) {
    const World world;
    EXPECT_THROW(pagesOf(world.atlas, 16), std::runtime_error);
}

TEST(Dilate, EveryTexelHasTheNearestKnownOneOfItsChart) {
    const World world;
    const Atlas& atlas = world.atlas;
    std::vector<glm::vec3> values = places(atlas);
    std::vector<uint8_t> known(values.size(), 0);
    Rng rng(3);
    for (size_t i = 0; i < known.size(); ++i) {
        known[i] = atlas.chartAt(i) != kNoChart && atlas.chartAt(i) > 0 &&
                   rng.uniform() < 0.01f;  // none in the first chart
        if (!known[i]) values[i] = glm::vec3(0);
    }
    dilateWithinCharts(values, known, atlas);
    const auto texelOf = [&](size_t i) { return glm::vec2(i % atlas.sizeTexels.x, i / atlas.sizeTexels.x); };
    size_t filled = 0;
    for (size_t i = 0; i < known.size(); ++i) {
        if (atlas.chartAt(i) == kNoChart || atlas.chartAt(i) == 0) {
            ASSERT_EQ(values[i], glm::vec3(0));
            continue;
        }
        float nearest = INFINITY;
        for (size_t j = 0; j < known.size(); ++j)
            if (known[j] && atlas.chartAt(j) == atlas.chartAt(i))
                nearest = std::min(nearest, glm::distance(texelOf(i), texelOf(j)));
        if (nearest == INFINITY) continue;  // a chart may have none
        const size_t from = size_t(values[i].y) * atlas.sizeTexels.x + size_t(values[i].x);
        ASSERT_EQ(values[i].z, 1);
        ASSERT_TRUE(known[from]);
        ASSERT_EQ(atlas.chartAt(from), atlas.chartAt(i));
        // Danielsson's error is at most a tenth of a texel.
        ASSERT_LE(glm::distance(texelOf(i), texelOf(from)), nearest + 0.1f);
        filled += !known[i];
    }
    EXPECT_GT(filled, 10'000u);
}

}  // namespace
}  // namespace phat
