// Bakes for light that comes later (BakeSettings::dynamic): what is dark then can light up.

#include <gtest/gtest.h>

#include "core/bake/visible_sides.h"
#include "core/dynamic/incremental_baker.h"
#include "support/moving_room.h"

namespace phat {
namespace {

using namespace test;

constexpr uint32_t kScreen = 10, kBox = 11, kLamp = 17, kFarWall = 9;  // surfaces

Material doubleSided(float albedo) {
    Material material = lambert(albedo);
    material.doubleSided = true;
    return material;
}

// A room that a double-sided screen divides: a small light in the one half, in the other a box that is closed
// and a lamp's panel.
Scene dividedRoom(float lampNit) {
    Scene scene;
    const Material wall = lambert(0.6f);
    const glm::vec3 x(2, 0, 0), y(0, 3, 0), z(0, 0, 4);
    for (const glm::vec3 corner : {glm::vec3(0), x}) {
        addQuad(scene, wall, corner, z, x);
        addQuad(scene, wall, corner + y, x, z);
        addQuad(scene, wall, corner, x, y);
        addQuad(scene, wall, corner + z, y, x);
        if (corner.x > 0)
            addQuad(scene, wall, corner + x, z, y);
        else
            addQuad(scene, wall, corner, y, z);
    }
    addQuad(scene, doubleSided(0.6f), x, z, y);
    addOutwardBox(scene, doubleSided(0.6f), {2.8f, 0, 1}, {0.6f, 0.6f, 0.6f});
    addQuad(scene, emitter(glm::vec3(lampNit)), {2.6f, 2.9f, 1.6f}, {0.8f, 0, 0}, {0, 0, 0.8f});
    scene.lights = {pointLight(glm::vec3(0.5f), {1, 1.5f, 2})};
    return scene;
}

BakeSettings settingsOf(bool dynamic) {
    BakeSettings settings = smallBake();
    settings.atlas.texelBudget = 8'000;
    settings.dynamic = dynamic;
    return settings;
}

Bake bakeOf(const Scene& scene, bool dynamic) {
    SilentProgress progress;
    return bake(scene, settingsOf(dynamic), progress);
}

/// Which sides of a surface have charts.
NeededSides chartsOf(const Atlas& atlas, uint32_t surface) {
    NeededSides sides;
    for (const Chart& chart : atlas.charts)
        if (chart.surface == surface) (chart.back ? sides.back : sides.front) = true;
    return sides;
}

/// W/m2: of the texels of one side, the mean irradiance of all light that a bake holds.
double meanIrradiance(const Atlas& atlas, const TexelPoints& points, const Phatexture& light,
                      uint32_t surface, bool back) {
    double sum = 0;
    size_t count = 0;
    for (size_t i = 0; i < points.state.size(); ++i) {
        if (points.state[i] != TexelState::surface) continue;
        const Chart& chart = atlas.charts[atlas.chartAt(i)];
        if (atlas.triangleSurface[points.triangle[i]] != surface || chart.back != back) continue;
        ++count;
        sum += double(luminance(unpackRgb9e5(light.indirectIrradiance[i])));
        if (!light.areaIrradiance.empty()) sum += double(luminance(unpackRgb9e5(light.areaIrradiance[i])));
    }
    return count > 0 ? sum / double(count) : -1;
}

// The screen's back looks at the lamp's half.
TEST(LaterLight, ALampThatIsSwitchedOnLightsTheDarkHalf) {
    const Scene dark = dividedRoom(0), lit = dividedRoom(5);
    const Bake baked = bakeOf(dark, true);
    EXPECT_GT(baked.stats.darkTexels, 0u);
    ASSERT_TRUE(chartsOf(baked.atlas, kScreen).back);
    EXPECT_FALSE(chartsOf(baked.atlas, kBox).back) << "the inside of a closed box";
    EXPECT_EQ(meanIrradiance(baked.atlas, baked.points, baked.phatexture, kScreen, true), 0);

    PosedScene posed(dark);
    IncrementalBaker engine(posed.snapshot(), baked.atlas, baked.points, baked.phatexture, settingsOf(true));
    SceneState on = stateOf(dark);
    on.materials[dark.surfaces[kLamp].material] = lit.materials[lit.surfaces[kLamp].material];
    ASSERT_TRUE(engine.setScene(posedAs(posed, on)));
    SilentProgress progress;
    engine.converge(progress);

    const Bake wanted = bakeOf(lit, false);
    // Of bakes with two seeds these means differ by up to .7 %.
    constexpr double kNoise = 0.02;
    for (const auto& [surface, back] : {std::pair(kScreen, true), std::pair(kScreen, false),
                                        std::pair(kFarWall, false), std::pair(kBox + 3, false)}) {
        const double now = meanIrradiance(baked.atlas, baked.points, engine.phatexture(), surface, back);
        const double other = meanIrradiance(wanted.atlas, wanted.points, wanted.phatexture, surface, back);
        EXPECT_GT(other, 0) << surface;
        EXPECT_NEAR(now, other, kNoise * other) << surface << back;
    }
}

TEST(LaterLight, WithoutTheSettingTheDarkSideStaysDark) {
    const Bake baked = bakeOf(dividedRoom(0), false);
    EXPECT_FALSE(chartsOf(baked.atlas, kScreen).back);
    EXPECT_TRUE(baked.phatexture.area.empty());
    EXPECT_EQ(baked.stats.darkTexels, 0u);
}

}  // namespace
}  // namespace phat
