#include <gtest/gtest.h>

#include "core/atlas/atlas_checks.h"
#include "core/atlas/atlas_shapes.h"

namespace phat {
namespace {

AtlasSettings uvSet(int set) {
    AtlasSettings settings;
    settings.useUvSet = set;
    settings.texelBudget = 1 << 16;
    return settings;
}

Atlas build(const Scene& scene, int set, AtlasStats* stats = nullptr) {
    SilentProgress progress;
    return buildAtlas(scene, {}, uvSet(set), progress, stats);
}

// Two planes side by side in the square; the second at a third of the first one's scale and mirrored.
Scene twoIslands() {
    Scene scene = shapes::plane(1, 1, 4);
    const Scene copy = scene;
    shapes::add(scene, copy.positions, copy.triangles);
    for (size_t v = 0; v < scene.positions.size(); ++v) {
        const glm::vec2 p(scene.positions[v]);
        scene.uv1.push_back(v < copy.positions.size() ? 0.6f * p : glm::vec2(0.95f - 0.2f * p.x, 0.2f * p.y));
    }
    return scene;
}

std::string refusal(const Scene& scene, int set) {
    try {
        build(scene, set);
    } catch (const std::runtime_error& error) {
        return error.what();
    }
    return "accepted";
}

TEST(AtlasUvSet, IslandsAreRepackedAtOneDensity) {
    const Scene scene = twoIslands();
    AtlasStats stats;
    const Atlas atlas = build(scene, 1, &stats);
    expectSoundAtlas(scene, atlas, uvSet(1));
    EXPECT_EQ(atlas.charts.size(), 2u);
    EXPECT_FLOAT_EQ(stats.areaWithinStretch15, 1.0f);
    for (uint32_t t = 0; t < scene.triangles.size(); ++t) {
        const glm::dvec2 sigma = singularValues(scene, atlas, t);
        EXPECT_NEAR(sigma.x, 1.0, 1e-3);
        EXPECT_NEAR(sigma.y, 1.0, 1e-3);
    }
}

TEST(AtlasUvSet, KeepsTheShapeOfStretchedIslands) {
    Scene scene = shapes::plane(1, 1, 4);
    for (const glm::vec3& p : scene.positions) scene.uv0.push_back({p.x, 0.25f * p.y});
    AtlasStats stats;
    const Atlas atlas = build(scene, 0, &stats);
    EXPECT_EQ(stats.areaWithinStretch15, 0.0f);  // reported, not repaired
    const glm::dvec2 sigma = singularValues(scene, atlas, 0);
    EXPECT_NEAR(sigma.y / sigma.x, 4.0, 1e-2);
    EXPECT_NEAR(sigma.y * sigma.x, 1.0, 1e-2);
}

TEST(AtlasUvSet, SeamsSplitWhatPositionsJoin) {
    Scene scene;
    shapes::addGrid(scene, 2, 1, [](float u, float v) { return glm::vec3(u, v, 0); });
    scene.uv0 = {{0, 0}, {0.3f, 0}, {0.6f, 0}, {0, 0.5f}, {0.3f, 0.5f}, {0.6f, 0.5f}};
    EXPECT_EQ(build(scene, 0).charts.size(), 1u);
    // The second quad gets vertices of its own, at the same positions.
    scene.positions.insert(scene.positions.end(), {scene.positions[1], scene.positions[4]});
    scene.normals.resize(8, glm::vec3(0, 0, 1));
    scene.uv0.insert(scene.uv0.end(), {{0.35f, 0}, {0.35f, 0.5f}});
    scene.surfaces[0].vertexCount = 8;
    for (const uint32_t t : {2u, 3u})
        for (int corner = 0; corner < 3; ++corner) {
            uint32_t& v = scene.triangles[t][corner];
            v = v == 1 ? 6 : v == 4 ? 7 : v;
        }
    EXPECT_EQ(build(scene, 0).charts.size(), 2u);
}

TEST(AtlasUvSet, RefusesWhatCannotServe) {
    Scene scene = twoIslands();
    EXPECT_EQ(refusal(scene, 1), "accepted");
    EXPECT_EQ(refusal(scene, 0), "UV set 0: the scene does not have it");
    EXPECT_EQ(refusal(scene, 2), "UV set 2: only sets 0 and 1 can serve");

    Scene outside = scene;
    for (glm::vec2& p : outside.uv1) p.x += 0.1f;
    EXPECT_EQ(refusal(outside, 1), "UV set 1: triangle 32 lies outside [0, 1]");

    Scene infinite = scene;
    infinite.uv1[scene.triangles[5][0]].y = NAN;
    EXPECT_NE(refusal(infinite, 1).find("not finite"), std::string::npos);

    Scene flat = scene;
    for (size_t v = 25; v < 50; ++v) flat.uv1[v] = {0.9f, 0.1f};
    EXPECT_EQ(refusal(flat, 1), "UV set 1: triangle 32 has no area");

    Scene instanced = scene;
    for (size_t v = 25; v < 50; ++v) instanced.uv1[v] = scene.uv1[v - 25];
    EXPECT_EQ(refusal(instanced, 1), "UV set 1: triangles 0 and 32 overlap");

    // Folded along an inner edge: neighbours lie on each other.
    Scene folded = shapes::plane(1, 1, 2);
    for (const glm::vec3& p : folded.positions) folded.uv1.push_back({0.5f - std::abs(p.x - 0.5f), p.y});
    EXPECT_NE(refusal(folded, 1).find("overlap"), std::string::npos);
}

}  // namespace
}  // namespace phat
