#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <numeric>
#include <set>

#include "core/atlas/atlas_checks.h"
#include "core/atlas/atlas_shapes.h"

namespace phat {
namespace {

AtlasSettings smallAtlas() {
    AtlasSettings settings;
    settings.texelBudget = 1 << 17;
    return settings;
}

struct Shape {
    const char* name;
    Scene scene;
};

std::vector<Shape> allShapes() {
    std::vector<Shape> shapes;
    shapes.push_back({"plane", shapes::plane(3, 2)});
    shapes.push_back({"fine plane", shapes::plane(3, 2, 20)});
    shapes.push_back({"strip", shapes::plane(10, 0.02f, 6)});
    shapes.push_back({"cube", shapes::cube(1)});
    shapes.push_back({"sphere", shapes::sphere(1)});
    shapes.push_back({"torus", shapes::torus(1, 0.35f)});
    shapes.push_back({"cylinder", shapes::cylinder(0.5f, 2)});
    shapes.push_back({"moebius strip", shapes::moebius(1, 0.5f)});
    shapes.push_back({"soup", shapes::soup(150)});
    shapes.push_back({"ramp", shapes::ramp(3)});
    return shapes;
}

TEST(AtlasUnwrap, EveryShapeHasASoundNearIsometricAtlas) {
    for (const Shape& shape : allShapes()) {
        SCOPED_TRACE(shape.name);
        SilentProgress progress;
        AtlasStats stats;
        const Atlas atlas = buildAtlas(shape.scene, {}, smallAtlas(), progress, &stats);
        expectSoundAtlas(shape.scene, atlas, smallAtlas());
        const double share = fractionWithinStretch(shape.scene, atlas, 1.5);
        EXPECT_GE(share, 0.95);
        // Not exactly: the statistic is taken in double precision before the corners are rounded to floats.
        EXPECT_NEAR(stats.areaWithinStretch15, share, 0.01);
        EXPECT_EQ(stats.chartCount, atlas.charts.size());
    }
}

TEST(AtlasUnwrap, BudgetIsMetWithinTenPercent) {
    for (const Shape& shape : allShapes()) {
        SCOPED_TRACE(shape.name);
        AtlasSettings settings;
        settings.texelBudget = 1 << 18;
        SilentProgress progress;
        const Atlas atlas = buildAtlas(shape.scene, {}, settings, progress);
        EXPECT_LT(double(atlas.texelCount()), 1.1 * double(settings.texelBudget));
        if (double(atlas.texelCount()) > 0.9 * double(settings.texelBudget)) continue;
        // A long strip leaps from three tiles across to four: then finer texels must exceed the budget.
        AtlasSettings finer = settings;
        finer.texelSizeMeters = atlas.texelSizeMeters / 1.05f;
        EXPECT_GT(buildAtlas(shape.scene, {}, finer, progress).texelCount(), settings.texelBudget);
    }
}

TEST(AtlasUnwrap, RequestedTexelSizeIsKept) {
    AtlasSettings settings;
    settings.texelSizeMeters = 0.01f;
    SilentProgress progress;
    const Scene scene = shapes::cube(1);
    const Atlas atlas = buildAtlas(scene, {}, settings, progress);
    EXPECT_EQ(atlas.texelSizeMeters, 0.01f);
    for (uint32_t t = 0; t < scene.triangles.size(); ++t) EXPECT_NEAR(texelAreaOf(atlas, t), 5000.0, 1.0);
    settings.texelSizeMeters = 1e-5f;  // 100,000 texels a side
    EXPECT_THROW(buildAtlas(scene, {}, settings, progress), std::runtime_error);
}

TEST(AtlasUnwrap, FlatFacesAreOneChartEach) {
    SilentProgress progress;
    EXPECT_EQ(buildAtlas(shapes::plane(3, 2, 20), {}, smallAtlas(), progress).charts.size(), 1u);
    EXPECT_EQ(buildAtlas(shapes::cube(1), {}, smallAtlas(), progress).charts.size(), 6u);
}

// 80 degrees of arc fit in a cone of 40; five such strips close a cylinder, each a rectangle.
TEST(AtlasUnwrap, CylinderUnrollsIntoRectangles) {
    SilentProgress progress;
    AtlasStats stats;
    const Scene scene = shapes::cylinder(0.5f, 2, 80);
    AtlasSettings settings;
    const Atlas atlas = buildAtlas(scene, {}, settings, progress, &stats);
    EXPECT_LE(atlas.charts.size(), 6u);
    EXPECT_GT(fractionWithinStretch(scene, atlas, 1.02), 0.99);
    EXPECT_GT(stats.coverage, 0.9f);
}

// Six caps of 40 degrees cannot cover a sphere (each is 11.7 % of it): at least nine are needed.
TEST(AtlasUnwrap, SphereNeedsFewCharts) {
    SilentProgress progress;
    const Scene scene = shapes::sphere(1, 96, 48);
    const Atlas atlas = buildAtlas(scene, {}, AtlasSettings{}, progress);
    EXPECT_GE(atlas.charts.size(), 9u);
    EXPECT_LE(atlas.charts.size(), 24u);
    EXPECT_GT(fractionWithinStretch(scene, atlas, 1.15), 0.95);
}

// A ring as one piece fills (pi (1 - .8^2)) / 4 of its square; quarters fill more even with their gutters.
TEST(AtlasUnwrap, RingsAreCutIntoArcs) {
    Scene scene;
    shapes::addGrid(scene, 64, 2, [](float u, float v) {
        const float a = u == 1 ? 0 : 2 * kPi * u, r = 1 - 0.2f * v;
        return glm::vec3(r * std::cos(a), r * std::sin(a), 0);
    });
    SilentProgress progress;
    AtlasStats stats;
    const Atlas atlas = buildAtlas(scene, {}, AtlasSettings{}, progress, &stats);
    EXPECT_GT(atlas.charts.size(), 1u);
    EXPECT_GT(stats.coverage, kPi * (1 - 0.64f) / 4);
}

// The floor around a room: its triangles reach from corner to corner, and its box is mostly the room.
TEST(AtlasUnwrap, FramesAreCutIntoBars) {
    Scene scene;
    const float a = 0.4f, b = 5.6f;
    shapes::add(scene,
                {{0, 0, 0}, {6, 0, 0}, {6, 6, 0}, {0, 6, 0}, {a, a, 0}, {b, a, 0}, {b, b, 0}, {a, b, 0}},
                {{0, 1, 4}, {1, 5, 4}, {1, 2, 5}, {2, 6, 5}, {2, 3, 6}, {3, 7, 6}, {3, 0, 7}, {0, 4, 7}});
    SilentProgress progress;
    AtlasStats stats;
    const Atlas atlas = buildAtlas(scene, {}, AtlasSettings{}, progress, &stats);
    expectSoundAtlas(scene, atlas, AtlasSettings{});
    EXPECT_EQ(atlas.charts.size(), 4u);
    EXPECT_GT(stats.coverage, 0.75f);  // of the frame's box it fills a quarter
}

// Strips along bent tubes, narrower than a texel: their boxes are some hundred times their area.
TEST(AtlasUnwrap, BentTubesTakeFewTexels) {
    Scene scene = shapes::plane(4, 4);
    for (int i = 0; i < 50; ++i)
        shapes::addGrid(scene, 48, 8, [i](float u, float v) {
            const float along = kPi * u, around = v == 1 ? 0 : 2 * kPi * v,
                        r = 0.4f + 0.004f * std::cos(around);
            return glm::vec3(r * std::cos(along) + float(i % 10), 0.004f * std::sin(around) + float(i / 10),
                             1 + r * std::sin(along));
        });
    scene = shapes::joined(std::move(scene));
    AtlasSettings settings;
    settings.texelBudget = 40'000;
    SilentProgress progress;
    const Atlas atlas = buildAtlas(scene, {}, settings, progress);
    expectSoundAtlas(scene, atlas, settings);
    EXPECT_LT(double(atlas.texelSizeMeters),
              1.6 * std::sqrt(surfaceArea(scene) / double(settings.texelBudget)));
}

// Each chart needs 2 x 2 tiles for its gutters, whatever the texel size: the budget has to give way, but not
// the triangles' texels.
TEST(AtlasUnwrap, ManySmallChartsExceedTheBudgetByTheirGuttersOnly) {
    constexpr uint32_t kCount = 2000;
    const Scene scene = shapes::soup(kCount);
    AtlasSettings settings;
    settings.texelBudget = 1 << 16;
    SilentProgress progress;
    const Atlas atlas = buildAtlas(scene, {}, settings, progress);
    expectSoundAtlas(scene, atlas, settings);
    EXPECT_LT(double(atlas.texelCount()), 1.25 * kCount * 4 * kTileSize * kTileSize);
    std::vector<double> areas;
    for (uint32_t t = 0; t < kCount; ++t) areas.push_back(texelAreaOf(atlas, t));
    std::nth_element(areas.begin(), areas.begin() + kCount / 2, areas.end());
    EXPECT_GT(areas[kCount / 2], 1.0);
}

TEST(AtlasUnwrap, FlippedTrianglesGetChartsOfTheirOwn) {
    Scene scene = shapes::plane(2, 2, 8);
    for (const uint32_t t : {10u, 37u, 90u}) std::swap(scene.triangles[t][1], scene.triangles[t][2]);
    SilentProgress progress;
    const Atlas atlas = buildAtlas(scene, {}, smallAtlas(), progress);
    expectSoundAtlas(scene, atlas, smallAtlas());
    EXPECT_EQ(atlas.charts.size(), 4u);
}

TEST(AtlasUnwrap, CoincidentCopiesDoNotShareTexels) {
    // The same faces three times over the same vertices, the last time facing the other way.
    Scene scene = shapes::plane(2, 2, 6);
    const std::vector<glm::uvec3> once = scene.triangles;
    for (const glm::uvec3& t : once) scene.triangles.push_back(t);
    for (const glm::uvec3& t : once) scene.triangles.push_back({t.x, t.z, t.y});
    scene.triangleSurface.assign(scene.triangles.size(), 0);
    scene.surfaces[0].triangleCount = uint32_t(scene.triangles.size());
    SilentProgress progress;
    const Atlas atlas = buildAtlas(scene, {}, smallAtlas(), progress);
    expectSoundAtlas(scene, atlas, smallAtlas());
    EXPECT_LE(atlas.charts.size(), 6u);
}

TEST(AtlasUnwrap, DegenerateTrianglesHaveNoChart) {
    Scene scene = shapes::plane(2, 2, 4);
    const uint32_t first = uint32_t(scene.triangles.size());
    scene.triangles.push_back({0, 0, 1});
    scene.triangles.push_back({0, 1, 2});  // on a line
    scene.triangles.push_back({3, 3, 3});
    scene.triangleSurface.resize(scene.triangles.size(), 0);
    scene.surfaces[0].triangleCount = uint32_t(scene.triangles.size());
    SilentProgress progress;
    AtlasStats stats;
    const Atlas atlas = buildAtlas(scene, {}, smallAtlas(), progress, &stats);
    for (uint32_t t = 0; t < scene.triangles.size(); ++t)
        EXPECT_EQ(atlas.triangleChart[t] == kNoChart, t >= first) << t;
    EXPECT_EQ(stats.degenerateTriangles, 3u);
}

TEST(AtlasUnwrap, EmptySceneGivesAnEmptyAtlas) {
    SilentProgress progress;
    const Scene scene;
    const Atlas atlas = buildAtlas(scene, {}, AtlasSettings{}, progress);
    EXPECT_EQ(atlas.charts.size(), 0u);
    EXPECT_EQ(buildTexelPoints(scene, atlas).state.size(), atlas.texelCount());
}

TEST(AtlasUnwrap, ComponentsFollowWeldedPositionsWithinASurface) {
    Scene scene = shapes::cylinder(1, 1, 12);  // its seam is closed by position only
    shapes::add(scene, {{5, 0, 0}, {6, 0, 0}, {5, 1, 0}}, {{0, 1, 2}});
    shapes::add(scene, {{5, 0, 0}, {5, 1, 0}, {4, 0, 0}}, {{0, 1, 2}});  // touches the last, other surface
    const std::vector<uint32_t> components = connectedComponents(scene);
    const uint32_t last = uint32_t(components.size()) - 1;
    EXPECT_EQ(*std::max_element(components.begin(), components.end()), 2u);
    for (uint32_t t = 0; t + 1 < last; ++t) EXPECT_EQ(components[t], 0u);
    EXPECT_EQ(components[last - 1], 1u);
    EXPECT_EQ(components[last], 2u);
}

TEST(AtlasUnwrap, BothSidesGetChartsOfOneLayout) {
    Scene scene = shapes::cylinder(0.5f, 1);
    shapes::add(scene, {{2, 0, 0}, {3, 0, 0}, {2, 1, 0}}, {{0, 1, 2}});
    SilentProgress progress;
    const Atlas atlas = buildAtlas(scene, {Sides::both, Sides::back}, smallAtlas(), progress);
    expectSoundAtlas(scene, atlas, smallAtlas());
    uint32_t pairs = 0;
    for (uint32_t c = 0; c < atlas.charts.size(); ++c) {
        const Chart& chart = atlas.charts[c];
        if (chart.surface == 1) {
            EXPECT_TRUE(chart.back);
            EXPECT_EQ(chart.otherSide, kNoChart);
            continue;
        }
        ASSERT_NE(chart.otherSide, kNoChart);
        const Chart& other = atlas.charts[chart.otherSide];
        EXPECT_EQ(other.otherSide, c);
        EXPECT_NE(other.back, chart.back);
        EXPECT_EQ(other.sizeTiles, chart.sizeTiles);
        pairs += chart.back;
    }
    EXPECT_GE(pairs, 5u);
    for (uint32_t t = 0; t + 1 < scene.triangles.size(); ++t)
        EXPECT_FALSE(atlas.charts[atlas.triangleChart[t]].back);
}

TEST(AtlasUnwrap, SameBytesForAnyNumberOfThreads) {
    Scene scene = shapes::torus(1, 0.35f);
    const Scene other = shapes::sphere(1);
    shapes::add(scene, other.positions, other.triangles);
    SilentProgress progress;
    std::vector<Atlas> atlases;
    std::vector<TexelPoints> points;
    for (const int threads : {1, 2, 8}) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        atlases.push_back(buildAtlas(scene, {}, smallAtlas(), progress));
        points.push_back(buildTexelPoints(scene, atlases.back()));
    }
    for (size_t i = 1; i < atlases.size(); ++i) {
        EXPECT_EQ(atlases[i].triangleChart, atlases[0].triangleChart);
        EXPECT_EQ(atlases[i].triangleTexels, atlases[0].triangleTexels);
        EXPECT_EQ(atlases[i].tileChart, atlases[0].tileChart);
        EXPECT_EQ(points[i].state, points[0].state);
        EXPECT_EQ(points[i].position, points[0].position);
        EXPECT_EQ(points[i].normal, points[0].normal);
    }
}

class StopAtOnce : public SilentProgress {
  public:
    bool stopRequested() const override { return true; }
};

TEST(AtlasUnwrap, StopsWhenAsked) {
    StopAtOnce progress;
    EXPECT_THROW(buildAtlas(shapes::sphere(1), {}, AtlasSettings{}, progress), Interrupted);
}

}  // namespace
}  // namespace phat
