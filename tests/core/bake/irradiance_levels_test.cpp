// Smoothing and interpolation of irradiance between nodes, on a flat floor.

#include "core/bake/irradiance_levels.h"

#include <gtest/gtest.h>

#include <numeric>

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
        const std::vector<uint8_t> all(atlas.texelCount(), 1);
        level = makeLevel(atlas, all, kLevelSteps[0], [](glm::uvec2) { return true; });
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

}  // namespace
}  // namespace phat
