// Smoothing and interpolation of irradiance between nodes, on a flat floor.

#include "core/bake/irradiance_levels.h"

#include <gtest/gtest.h>

#include <numeric>

#include "core/atlas/atlas_shapes.h"
#include "core/bake/irradiance_split.h"
#include "support/scene_builder.h"

namespace phat {
namespace {

struct Floor {
    Scene scene;
    Atlas atlas;
    TexelPoints points;
    IrradianceLevel level;

    Floor() {
        test::addFloor(scene, Material(), 4);
        AtlasSettings settings;
        settings.texelBudget = 1 << 15;
        SilentProgress progress;
        atlas = buildAtlas(scene, {Sides::front}, settings, progress);
        points = buildTexelPoints(scene, atlas);
        const std::vector<uint8_t> receives = irradianceTexels(atlas, points);
        level = makeLevel({atlas, points, receives}, kLevelSteps[0], [](glm::uvec2) { return true; });
        level.value.assign(level.texel.size(), glm::vec3(1));
        level.distanceTexels.assign(level.texel.size(), 1e6f);
    }
    /// The node nearest the middle of the atlas.
    size_t middle() const {
        const glm::uvec2 group = level.size / 2u;
        return level.node[size_t(group.y) * level.size.x + group.x];
    }
    IrradianceMap map() const {
        IrradianceMap map;
        finish(interpolateLevels({level}, atlas, points, {}, map, kNoSlicing));
        return map;
    }
    double sum(const IrradianceMap& map) const {
        double sum = 0;
        for (size_t i = 0; i < map.size(); ++i)
            if (points.valid(i)) sum += double(map[i].x);
        return sum;
    }
};

// One node had a ray that found a lamp: no spot, and the light is not lost.
TEST(IrradianceLevels, RareBrightRaysMakeNoSpots) {
    Floor floor;
    const double before = floor.sum(floor.map());
    constexpr float kExcess = 20;
    floor.level.value[floor.middle()] += kExcess;
    const IrradianceMap map = floor.map();
    float largest = 0;
    for (size_t i = 0; i < map.size(); ++i)
        if (floor.points.valid(i)) largest = std::max(largest, map[i].x);
    EXPECT_LT(largest, 1 + 0.02f * kExcess);
    const double added = kExcess * square(float(floor.level.step));
    EXPECT_NEAR(floor.sum(map) - before, added, 0.1 * added);
}

// What several nodes see is there.
TEST(IrradianceLevels, BrightRegionsStay) {
    Floor floor;
    const glm::uvec2 middle = floor.level.size / 2u;
    for (uint32_t y = 0; y < 8; ++y)
        for (uint32_t x = 0; x < 8; ++x)
            floor.level.value[floor.level.node[size_t(middle.y + y) * floor.level.size.x + middle.x + x]] =
                glm::vec3(5);
    const IrradianceMap map = floor.map();
    EXPECT_NEAR(
        (*std::max_element(map.begin(), map.end(), [](glm::vec3 a, glm::vec3 b) { return a.x < b.x; })).x, 5,
        0.5);
}

// At an edge of light, far from all other surfaces, there are finer nodes; where light is even there are
// none.
TEST(IrradianceLevels, EdgesOfLightHaveFinerNodes) {
    const Floor floor;
    const std::vector<uint8_t> receives = irradianceTexels(floor.atlas, floor.points);
    const uint32_t edge = floor.atlas.sizeTexels.x / 2;
    const auto finerAtALightOf = [&](float light) {
        IrradianceMap map(floor.atlas.texelCount(), glm::vec3(1));
        for (size_t i = 0; i < map.size(); ++i)
            if (i % floor.atlas.sizeTexels.x >= edge) map[i] = glm::vec3(light);
        return finerLevel({floor.atlas, floor.points, receives}, floor.level, kLevelSteps[1], map, {});
    };
    EXPECT_TRUE(finerAtALightOf(1.3f).texel.empty());
    const IrradianceLevel finer = finerAtALightOf(2);
    EXPECT_GT(finer.texel.size(), 50u);
    for (const uint32_t texel : finer.texel)
        EXPECT_LE(std::abs(int(texel % floor.atlas.sizeTexels.x) - int(edge)), int(2 * kLevelSteps[0]));
}

/// Small boxes, each a surface, whose faces share charts.
Scene boxes() {
    Scene scene;
    for (int i = 0; i < 100; ++i) {
        Scene box = shapes::cube(1);
        for (glm::vec3& p : box.positions)
            p = p * glm::vec3(0.05f, 0.03f, 0.04f) + 0.2f * glm::vec3(float(i % 10), float(i / 10), 0);
        shapes::add(scene, box.positions, box.triangles);
    }
    return scene;
}

// What nodes are made of: the texels of a scene's atlas that receive light.
struct Receivers {
    Receivers(const Scene& scene, uint64_t texelBudget)
        : atlas(atlasOf(scene, texelBudget)),
          points(buildTexelPoints(scene, atlas)),
          receives(irradianceTexels(atlas, points)) {}

    static Atlas atlasOf(const Scene& scene, uint64_t texelBudget) {
        AtlasSettings settings;
        settings.texelBudget = texelBudget;
        SilentProgress progress;
        return buildAtlas(scene, {}, settings, progress);
    }

    Atlas atlas;
    TexelPoints points;
    std::vector<uint8_t> receives;
};

// Groups of texels have several small pieces; each piece has its own nodes, and its texels take their light
// alone.
TEST(IrradianceLevels, LightOfAPieceStaysOnIt) {
    const Scene scene = boxes();
    const auto [atlas, points, receives] = Receivers(scene, 40'000);
    IrradianceLevel level =
        makeLevel({atlas, points, receives}, kLevelSteps[0], [](glm::uvec2) { return true; });
    const auto lightOf = [&](size_t texel) {
        return glm::vec3(float(1 + scene.triangleSurface[points.triangle[texel]] % 7));
    };
    size_t groups = 0;
    for (const uint32_t node : level.node) groups += node != kNoNode;
    EXPECT_GT(level.texel.size(), groups * 5 / 4) << "no group has several pieces";
    for (const uint32_t texel : level.texel) level.value.push_back(lightOf(texel));
    level.distanceTexels.assign(level.texel.size(), 1e6f);
    IrradianceMap map;
    finish(interpolateLevels({level}, atlas, points, {}, map, kNoSlicing));
    for (size_t i = 0; i < map.size(); ++i) {
        if (!receives[i]) continue;
        ASSERT_NE(level.nodeOf(atlas, points, uint32_t(i)), kNoNode);
        ASSERT_NEAR(map[i].x, lightOf(i).x, 1e-4f) << i;
    }
}

// A piece rarely begins where a group does. A node in the middle of the group would be nearer the piece's
// border than the texels that it stands for, and light that falls off toward an edge would be taken for less
// than it is.
TEST(IrradianceLevels, NodesAreInTheMiddleOfTheirTexels) {
    Scene scene;  // of small plates
    for (int i = 0; i < 300; ++i) {
        const glm::vec3 low = 0.2f * glm::vec3(float(i % 20), float(i / 20), 0);
        const glm::vec3 x(0.05f + 0.001f * float(i % 7), 0, 0), y(0, 0.04f + 0.001f * float(i % 9), 0);
        shapes::add(scene, {low, low + x, low + x + y, low + y}, {{0, 1, 2}, {0, 2, 3}});
    }
    const auto [atlas, points, receives] = Receivers(scene, 60'000);
    const IrradianceLevel level =
        makeLevel({atlas, points, receives}, kLevelSteps[0], [](glm::uvec2) { return true; });
    const auto positionOf = [&](size_t texel) {
        return glm::dvec2(texel % atlas.sizeTexels.x, texel / atlas.sizeTexels.x);
    };
    std::vector<std::vector<uint32_t>> texels(level.node.size());
    for (uint32_t i = 0; i < receives.size(); ++i)
        if (receives[i]) texels[level.groupOf(i, atlas.sizeTexels.x)].push_back(i);
    size_t partial = 0;
    for (size_t group = 0; group < texels.size(); ++group) {
        const uint32_t node = level.node[group];
        if (node == kNoNode || level.next[node] != kNoNode) continue;
        partial += texels[group].size() < 16;
        glm::dvec2 middle(0);
        for (const uint32_t texel : texels[group]) middle += positionOf(texel) / double(texels[group].size());
        const double off = glm::distance(positionOf(level.texel[node]), middle);
        for (const uint32_t texel : texels[group])
            ASSERT_LE(off, glm::distance(positionOf(texel), middle) + 1e-5);
    }
    EXPECT_GT(partial, 100u);
}

}  // namespace
}  // namespace phat
