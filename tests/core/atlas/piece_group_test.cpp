// Small pieces that share a chart, and pieces that are joined in their plane.

#include "core/atlas/piece_group.h"

#include <gtest/gtest.h>

#include <map>
#include <set>

#include "core/atlas/atlas_checks.h"
#include "core/atlas/atlas_shapes.h"
#include "core/atlas/texel_neighbors.h"
#include "support/scene_builder.h"

namespace phat {
namespace {

/// A box of this size with its low corner there, six faces outward.
void addBox(Scene& scene, glm::vec3 low, glm::vec3 size) {
    Scene box = shapes::cube(1);
    glm::vec3 least(1e30f);
    for (const glm::vec3& p : box.positions) least = glm::min(least, p);
    for (glm::vec3& p : box.positions) p = low + (p - least) * size;
    if (scene.surfaces.empty())
        scene = box;
    else
        shapes::add(scene, box.positions, box.triangles);
}

/// Boxes of a few centimetres all over a room, in one surface.
Scene manyBoxes(int side, float spacing = 0.2f) {
    Scene scene;
    for (int i = 0; i < side * side; ++i)
        addBox(scene, {spacing * float(i % side), spacing * float(i / side), 0.05f * float(i % 7)},
               {0.05f + 0.01f * float(i % 5), 0.04f + 0.01f * float(i % 3), 0.03f});
    return shapes::joined(std::move(scene));
}

Atlas atlasOf(const Scene& scene, uint64_t budget, AtlasStats& stats) {
    AtlasSettings settings;
    settings.texelBudget = budget;
    SilentProgress progress;
    const Atlas atlas = buildAtlas(scene, {}, settings, progress, &stats);
    expectSoundAtlas(scene, atlas, settings);
    return atlas;
}

TEST(PieceGroup, ManySmallPiecesKeepTheBudgetAndFillTheAtlas) {
    const Scene scene = manyBoxes(20);  // 2,400 faces of about 20 mm x 60 mm
    AtlasStats stats;
    // 83 texels a face: a chart each would be one tile with 16 texels of surface, .2 of the atlas; six by six
    // with a ring are 36 of 64.
    const Atlas atlas = atlasOf(scene, 200'000, stats);
    EXPECT_LT(double(atlas.texelCount()), 1.1 * 200'000);
    EXPECT_LT(atlas.charts.size(), 300u);
    EXPECT_GT(stats.coverage, 0.4f);
    EXPECT_LT(double(atlas.texelSizeMeters), 1.6 * std::sqrt(surfaceArea(scene) / 200'000));
}

// Of all texels that bilinear lookups on a piece read with some weight, none belongs to another piece, but
// between pieces narrower than a texel.
TEST(PieceGroup, BilinearLookupsStayOnTheirPiece) {
    const Scene scene = manyBoxes(8);
    AtlasStats stats;
    const Atlas atlas = atlasOf(scene, 60'000, stats);
    const TexelPoints points = buildTexelPoints(scene, atlas);
    const std::vector<uint32_t> component = connectedComponents(scene);
    size_t shared = 0, read = 0;
    for (uint32_t t = 0; t < scene.triangles.size(); ++t) {
        const auto& corner = atlas.triangleTexels[t];
        for (const glm::vec2& weights : {glm::vec2(0.1f, 0.1f), glm::vec2(0.8f, 0.1f), glm::vec2(0.1f, 0.8f),
                                         glm::vec2(0), glm::vec2(1, 0), glm::vec2(0, 1)}) {
            const glm::vec2 p =
                corner[0] + weights.x * (corner[1] - corner[0]) + weights.y * (corner[2] - corner[0]);
            for (int i = 0; i < 4; ++i) {
                const glm::vec2 low = glm::floor(p - 0.5f), part = p - 0.5f - low;
                const glm::vec2 side(float(i & 1), float(i >> 1));
                const glm::vec2 weight = glm::mix(1.0f - part, part, side);
                if (weight.x * weight.y < 1e-3f) continue;
                const glm::uvec2 texel(low + side);
                const size_t index = size_t(texel.y) * atlas.sizeTexels.x + texel.x;
                ASSERT_EQ(atlas.chartAt(texel), atlas.triangleChart[t]);
                ++read;
                ASSERT_TRUE(points.valid(index));
                ASSERT_EQ(component[points.triangle[index]], component[t]);
            }
        }
    }
    for (uint32_t t = 0; t < scene.triangles.size(); ++t)
        for (uint32_t u = 0; u < t; ++u)
            shared += atlas.triangleChart[t] == atlas.triangleChart[u] && component[t] != component[u];
    EXPECT_GT(shared, 1000u) << "no chart has several pieces";
    EXPECT_GT(read, 1000u);
}

// Where the size of the texels is given, small pieces have it, too.
TEST(PieceGroup, RequestedTexelSizeIsThatOfSmallPieces) {
    const Scene scene = manyBoxes(6);
    AtlasSettings settings;
    settings.texelSizeMeters = 0.008f;  // faces of 4 x 5 to 9 x 11 texels
    SilentProgress progress;
    const Atlas atlas = buildAtlas(scene, {}, settings, progress);
    EXPECT_LT(atlas.charts.size(), 100u) << "of 216 faces";
    for (uint32_t t = 0; t < scene.triangles.size(); ++t) {
        const double texels = areaOf(scene, t) / square(0.008);
        EXPECT_NEAR(texelAreaOf(atlas, t), texels, 1e-3 * texels);
    }
}

// The texels of a group's blocks must see the block's hemisphere, and the tangents must add up.
TEST(PieceGroup, PiecesFaceAsTheirBlock) {
    Scene scene = manyBoxes(10);
    const Scene ball = shapes::sphere(0.04f);
    for (int i = 0; i < 20; ++i) {
        Scene moved = ball;
        for (glm::vec3& p : moved.positions) p += glm::vec3(0.2f * float(i % 5), 0.2f * float(i / 5), 0.6f);
        shapes::add(scene, moved.positions, moved.triangles);
    }
    scene = shapes::joined(std::move(scene));
    AtlasStats stats;
    const Atlas atlas = atlasOf(scene, 60'000, stats);
    const TexelPoints points = buildTexelPoints(scene, atlas);
    const std::vector<Frame> frames = blockFrames(atlas, points);
    const std::vector<uint32_t> component = connectedComponents(scene);
    std::map<uint32_t, std::set<uint32_t>> componentsOf;  // per chart
    for (uint32_t t = 0; t < scene.triangles.size(); ++t)
        componentsOf[atlas.triangleChart[t]].insert(component[t]);
    size_t compared = 0;
    for (size_t i = 0; i < points.state.size(); ++i) {
        if (points.state[i] != TexelState::surface) continue;
        const glm::uvec2 texel(i % atlas.sizeTexels.x, i / atlas.sizeTexels.x);
        if (componentsOf[atlas.chartAt(texel)].size() < 2) continue;
        ++compared;
        const Frame& frame = frames[atlas.blockAt(texel)];
        // The triangle's own: the vertex normals of these boxes are those of their corners.
        const glm::uvec3& v = scene.triangles[points.triangle[i]];
        const glm::vec3 normal = glm::normalize(glm::cross(scene.positions[v.y] - scene.positions[v.x],
                                                           scene.positions[v.z] - scene.positions[v.x]));
        ASSERT_GT(glm::dot(normal, frame.normal), 0.0f);
        ASSERT_GT(glm::dot(points.tangent[i], frame.tangent), -0.3f);
    }
    EXPECT_GT(compared, 1000u);
}

// Pieces of a group are near each other in the world.
TEST(PieceGroup, PiecesOfAChartAreNear) {
    Scene scene = manyBoxes(6);
    Scene far = manyBoxes(6);
    for (glm::vec3& p : far.positions) p.x += 50;
    shapes::add(scene, far.positions, far.triangles);
    scene = shapes::joined(std::move(scene));
    AtlasStats stats;
    const Atlas atlas = atlasOf(scene, 40'000, stats);
    std::map<uint32_t, std::pair<float, float>> range;
    for (uint32_t t = 0; t < scene.triangles.size(); ++t) {
        const float x = scene.positions[scene.triangles[t].x].x;
        auto [found, fresh] = range.try_emplace(atlas.triangleChart[t], x, x);
        found->second = {std::min(found->second.first, x), std::max(found->second.second, x)};
    }
    for (const auto& [chart, x] : range) EXPECT_LT(x.second - x.first, 10);
}

TEST(PieceGroup, ManyTinyBudgetsAreKept) {
    const Scene scene = manyBoxes(20);
    for (const uint64_t budget : {20'000, 40'000, 200'000}) {
        AtlasStats stats;
        const Atlas atlas = atlasOf(scene, budget, stats);
        EXPECT_LT(double(atlas.texelCount()), 1.25 * double(budget)) << budget;
    }
}

/// The same boxes as manyBoxes, each a surface; every second one of node 1.
Scene boxesOfTwoNodes(int side) {
    Scene scene;
    for (int i = 0; i < side * side; ++i) {
        addBox(scene, {0.2f * float(i % side), 0.2f * float(i / side), 0}, glm::vec3(0.05f, 0.04f, 0.03f));
        scene.surfaces.back().node = uint32_t(i % 2);
    }
    scene.nodes.resize(2);
    return scene;
}

TEST(PieceGroup, SurfacesOfANodeShareCharts) {
    const Scene scene = boxesOfTwoNodes(12);
    AtlasStats stats;
    const Atlas atlas = atlasOf(scene, 40'000, stats);
    EXPECT_LT(atlas.charts.size(), 100u) << "of 144 surfaces";
    std::map<uint32_t, std::set<uint32_t>> surfacesOf, nodesOf;  // per chart
    for (uint32_t t = 0; t < scene.triangles.size(); ++t) {
        const uint32_t surface = scene.triangleSurface[t];
        surfacesOf[atlas.triangleChart[t]].insert(surface);
        nodesOf[atlas.triangleChart[t]].insert(scene.surfaces[surface].node);
    }
    size_t shared = 0;
    for (const auto& [chart, surfaces] : surfacesOf) {
        shared += surfaces.size() > 1;
        EXPECT_EQ(nodesOf[chart].size(), 1u) << "a node moves alone";
        EXPECT_EQ(surfaces.count(atlas.charts[chart].surface), 1u);
    }
    EXPECT_GT(shared, 10u);
}

// Texels of two surfaces never lie together, even where both are as in the atlas: a wall may stand between
// them.
TEST(PieceGroup, LightStaysOnItsSurface) {
    Scene scene;
    for (int i = 0; i < 400; ++i) {
        const glm::vec3 low(0.05f * float(i % 20), 0.05f * float(i / 20), 0), x(0.05f, 0, 0), y(0, 0.05f, 0);
        shapes::add(scene, {low, low + x, low + x + y, low + y}, {{0, 1, 2}, {0, 2, 3}});
    }
    AtlasStats stats;
    const Atlas atlas = atlasOf(scene, 20'000, stats);
    const TexelPoints points = buildTexelPoints(scene, atlas);
    size_t others = 0;
    for (size_t i = 0; i < points.state.size(); ++i)
        for (size_t j = i; j < std::min(i + 30, points.state.size()); ++j) {
            if (!points.valid(i) || !points.valid(j) || atlas.chartAt(i) != atlas.chartAt(j)) continue;
            if (scene.triangleSurface[points.triangle[i]] == scene.triangleSurface[points.triangle[j]])
                continue;
            ++others;
            ASSERT_FALSE(lieTogether(atlas, points, i, j));
        }
    EXPECT_GT(others, 1000u) << "no chart has several surfaces";
}

// Reflections are looked up by the chart: what is outside of a house does not shine into it.
TEST(PieceGroup, PiecesInsideAndOutsideShareNoChart) {
    Scene scene;
    test::addRoom(scene, Material(), glm::vec3(2));
    const size_t walls = scene.triangles.size();
    for (int i = 0; i < 16; ++i)
        for (const float y : {1.9f, 2.1f})
            test::addQuad(scene, Material(), {0.2f + 0.1f * float(i), y, 1}, {0, 0, 0.05f}, {0.05f, 0, 0});
    const RayScene rays(scene);
    AtlasSettings settings;
    settings.texelBudget = 60'000;
    SilentProgress progress;
    const Atlas atlas = buildAtlas(rays, {}, settings, progress);
    std::map<uint32_t, std::set<bool>> outside;  // per chart
    for (uint32_t t = uint32_t(walls); t < scene.triangles.size(); ++t)
        outside[atlas.triangleChart[t]].insert(scene.positions[scene.triangles[t].x].y > 2);
    EXPECT_LT(outside.size(), 16u) << "of 32 pieces";
    for (const auto& [chart, sides] : outside) EXPECT_EQ(sides.size(), 1u);
}

// The halves of a floor on both sides of a wall.
TEST(JoinCoplanar, PlanesOfTwoSurfacesStayApart) {
    Scene scene;
    for (const float x : {0.0f, 1.0f})
        shapes::add(scene, {{x, 0, 0}, {x + 1, 0, 0}, {x + 1, 1, 0}, {x, 1, 0}}, {{0, 1, 2}, {0, 2, 3}});
    AtlasStats stats;
    EXPECT_EQ(atlasOf(scene, 20'000, stats).charts.size(), 2u);
    EXPECT_EQ(atlasOf(shapes::joined(scene), 20'000, stats).charts.size(), 1u);
}

/// A floor of boards in one surface, a joint between them.
Scene boards(int rows, int perRow, float joint) {
    Scene scene;
    for (int i = 0; i < rows * perRow; ++i) {
        const glm::vec3 low(1.0f * float(i % perRow), 0.1f * float(i / perRow), 0);
        const glm::vec3 high = low + glm::vec3(1 - joint, 0.1f - joint, 0);
        const std::vector<glm::vec3> corners = {low, {high.x, low.y, 0}, high, {low.x, high.y, 0}};
        if (scene.surfaces.empty()) {
            scene = shapes::plane(1, 1);
            scene.positions = corners;
            scene.triangles = {{0, 1, 2}, {0, 2, 3}};
        } else {
            shapes::add(scene, corners, {{0, 1, 2}, {0, 2, 3}});
        }
    }
    return shapes::joined(std::move(scene));
}

TEST(JoinCoplanar, BoardsOfAFloorAreOneChart) {
    const Scene scene = boards(40, 4, 0.002f);
    AtlasStats stats;
    const Atlas atlas = atlasOf(scene, 20'000, stats);
    EXPECT_EQ(atlas.charts.size(), 1u);
    EXPECT_GT(stats.coverage, 0.75f);
    // They lie as in the world: one rigid motion.
    const TexelPoints points = buildTexelPoints(scene, atlas);
    size_t first = 0;
    while (points.state[first] != TexelState::surface) ++first;
    for (size_t i = 0; i < points.state.size(); ++i)
        if (points.state[i] == TexelState::surface) {
            ASSERT_TRUE(lieTogether(atlas, points, first, i));
        }
}

TEST(JoinCoplanar, WideJointsAndOtherHeightsKeepPiecesApart) {
    AtlasStats stats;
    const Scene apart = boards(4, 1, 0.06f);
    const Atlas wide = atlasOf(apart, 20'000, stats);  // joints of some fifteen texels
    Scene steps = boards(4, 1, 0.002f);
    for (size_t v = 0; v < steps.positions.size(); ++v) steps.positions[v].z = 0.1f * float(v / 4);
    const Atlas stairs = atlasOf(steps, 20'000, stats);
    for (const auto& [atlas, scene] : {std::pair(wide, apart), std::pair(stairs, steps)}) {
        const TexelPoints points = buildTexelPoints(scene, atlas);
        // Wherever they are: a texel of the first board does not lie beside one of the last as the atlas
        // says.
        std::vector<size_t> some(2, ~size_t(0));
        for (size_t i = 0; i < points.state.size(); ++i)
            if (points.state[i] == TexelState::surface)
                for (int end = 0; end < 2; ++end)
                    if (points.triangle[i] / 2 == 3u * uint32_t(end)) some[size_t(end)] = i;
        const uint32_t charts[] = {atlas.chartAt(some[0]), atlas.chartAt(some[1])};
        EXPECT_TRUE(charts[0] != charts[1] || !lieTogether(atlas, points, some[0], some[1]));
    }
}

}  // namespace
}  // namespace phat
