// A lamp that fills a gap with light, as those of coves and of panels under ceilings do.

#include <gtest/gtest.h>

#include "core/bake/bake.h"
#include "support/scene_builder.h"
#include "support/traced_irradiance.h"

namespace phat {
namespace {

using namespace test;

constexpr float kGap = 0.12f;
const glm::vec3 kRoom(3, 1.5f, 3), kLamp(0.9f, 0.04f, 0.9f);

Scene roomWithALampUnderTheCeiling() {
    Scene scene;
    addRoom(scene, lambert(0.8f), kRoom);
    const glm::vec3 low((kRoom.x - kLamp.x) / 2, kRoom.y - kGap - kLamp.y, (kRoom.z - kLamp.z) / 2);
    addOutwardBox(scene, emitter(glm::vec3(4), 0.9f), low, kLamp);
    return scene;
}

/// Of a point of the ceiling, from the lamp's outline; negative above the lamp.
float distanceFromLamp(glm::vec3 position) {
    const glm::vec2 from = glm::abs(glm::vec2(position.x, position.z) - 0.5f * glm::vec2(kRoom.x, kRoom.z)) -
                           0.5f * glm::vec2(kLamp.x, kLamp.z);
    return std::max(from.x, from.y);
}

struct Region {
    const char* name;
    double found = 0, truth = 0, variance = 0;
    int points = 0;

    void expect(double relative) const {
        ASSERT_GT(points, 20) << name;
        EXPECT_NEAR(found, truth, relative * truth + 3 * std::sqrt(variance)) << name;
        EXPECT_LT(3 * std::sqrt(variance), relative * truth) << name << ": the test tells nothing";
    }
};

// Outside of the gap, which is six texels high, irradiance falls to a tenth within its height. What is found
// there leaves for the room, so that the whole room depends on it. Smoothing carries some light across the
// lamp's edge, in one texel or two: less than a tenth of what is beside it.
TEST(Gap, ALampUnderTheCeilingLightsNoMoreThanPathsSay) {
    const Scene scene = roomWithALampUnderTheCeiling();
    BakeSettings settings;
    settings.atlas.texelBudget = 100'000;
    settings.photons.count = 20'000;
    settings.pathsPerPhatexel = 1;
    SilentProgress progress;
    const Bake result = bake(scene, settings, progress);
    const RayScene rays(scene);
    const LightSampler lights(scene);

    Region above{"above the lamp"}, beside{"beside the lamp"}, floor{"floor"};
    size_t seen = 0;
    for (size_t i = 0; i < result.points.state.size(); ++i) {
        if (result.points.state[i] != TexelState::surface) continue;
        const glm::vec3 position = result.points.position[i], normal = result.points.normal[i];
        const bool ceiling = normal.y < -0.9f && position.y > kRoom.y - 0.01f;
        const float distance = distanceFromLamp(position);
        Region* region = nullptr;
        if (ceiling && distance < -0.1f) region = &above;
        if (ceiling && distance > 0.04f && distance < 0.2f) region = &beside;
        if (normal.y > 0.9f && position.y < 0.01f) region = &floor;
        if (!region || hashOf(7, seen++) % (ceiling ? 6 : 96) != 0) continue;
        const auto [mean, deviation] = tracedIrradiance(rays, lights, position, normal, 2000, 64);
        region->found += luminance(unpackRgb9e5(result.phatexture.indirectIrradiance[i]));
        region->truth += mean;
        region->variance += deviation * deviation;
        ++region->points;
    }
    above.expect(0.05);
    beside.expect(0.1);
    floor.expect(0.02);
}

}  // namespace
}  // namespace phat
