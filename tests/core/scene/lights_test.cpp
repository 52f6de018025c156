#include "core/scene/lights.h"

#include <gtest/gtest.h>

#include "core/scene/light_punctual.h"
#include "support/scene_builder.h"

namespace phat {
namespace {

using namespace test;

bool isFinite(glm::vec3 v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

void expectNear(glm::vec3 value, glm::vec3 expected, float relative) {
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(value[i], expected[i], relative * maxComponent(expected)) << i;
}

Brdf whiteLambert() {
    return {.diffuseColor = glm::vec3(1), .f0 = glm::vec3(0), .f90 = 0};
}

TEST(Punctual, PointLightOverAWhitePlane) {
    Scene scene;
    scene.lights = {pointLight(glm::vec3(100), {0, 1, 0})};
    const LightSample sample = LightSampler(scene).samplePunctual(0, glm::vec3(0));
    ASSERT_EQ(sample.pdf, 1.0f);
    EXPECT_TRUE(sample.delta);
    EXPECT_EQ(sample.distance, 1.0f);
    const glm::vec3 up(0, 0, 1);
    EXPECT_NEAR((evaluateBrdf(whiteLambert(), up, up) * sample.radiance).x, 31.831f, 1e-3f);
}

// saturate((cos - cosOuter) / (cosInner - cosOuter))^2 at three places of the cone.
TEST(Punctual, SpotFallsOffAsTheExtensionSays) {
    Scene scene;
    scene.lights = {spotLight(glm::vec3(8), {0, 2, 0}, {0, -1, 0}, 30, 60)};
    const LightSampler lights(scene);
    const auto at = [&](float degrees) {
        const float angle = glm::radians(degrees);
        return lights.samplePunctual(0, {2 * std::sin(angle), 2 - 2 * std::cos(angle), 0});
    };
    EXPECT_FLOAT_EQ(at(0).radiance.x, 2.0f);
    EXPECT_FLOAT_EQ(at(29.9f).radiance.x, 2.0f);
    const float middle = (std::cos(glm::radians(45.0f)) - 0.5f) / (std::cos(glm::radians(30.0f)) - 0.5f);
    EXPECT_NEAR(at(45).radiance.x, 2.0f * middle * middle, 1e-5f);
    EXPECT_EQ(at(60.1f).pdf, 0.0f);
    EXPECT_EQ(at(180).pdf, 0.0f);
}

TEST(Punctual, SpotSolidAngleIsTheIntegralOfItsFalloff) {
    const float cones[][2] = {{30, 60}, {0, 45}, {44.99f, 45}, {0, 90}, {0, 1}, {0, 0.5f}};
    for (const auto& [inner, outer] : cones) {
        const SpotCone cone = spotCone(spotLight(glm::vec3(1), {}, {0, -1, 0}, inner, outer));
        double integral = 0;
        constexpr int kSteps = 2'000'000;
        for (int i = 0; i < kSteps; ++i) {
            integral += spotFalloff(cone, float(-1.0 + 2.0 * (i + 0.5) / kSteps)) * (2.0 / kSteps);
        }
        integral *= 2 * double(kPi);
        EXPECT_NEAR(spotSolidAngle(cone), integral, 2e-3 * integral) << inner << ' ' << outer;
    }
}

TEST(Punctual, NothingFallsOffWithinTheInnerCone) {
    for (const float degrees : {0.3f, 1.0f, 2.5f, 10.0f, 89.0f}) {
        Scene scene;
        scene.lights = {spotLight(glm::vec3(8), {}, {0, -1, 0}, degrees, degrees)};
        const LightSampler lights(scene);
        const auto at = [&](float fraction) {
            const float angle = fraction * glm::radians(degrees);
            return lights.samplePunctual(0, {2 * std::sin(angle), -2 * std::cos(angle), 0}).radiance.x;
        };
        EXPECT_NEAR(at(0), 2, 1e-5f) << degrees;
        EXPECT_NEAR(at(0.97f), 2, 1e-5f) << degrees;
        EXPECT_EQ(at(1.03f), 0) << degrees;
    }
}

TEST(Punctual, RangeEndsTheLight) {
    EXPECT_EQ(rangeAttenuation(1e6f, 0), 1.0f);
    EXPECT_FLOAT_EQ(rangeAttenuation(2, 4), 1.0f - 1.0f / 16);
    EXPECT_EQ(rangeAttenuation(4, 4), 0.0f);
    Scene scene;
    scene.lights = {pointLight(glm::vec3(1), {0, 4, 0})};
    scene.lights[0].rangeMeters = 3;
    EXPECT_EQ(LightSampler(scene).samplePunctual(0, glm::vec3(0)).pdf, 0.0f);
}

TEST(Punctual, EveryPositionGivesNumbers) {
    Scene scene;
    addFloor(scene, lambert(1), 2);
    scene.lights = {pointLight(glm::vec3(100), glm::vec3(0)),
                    spotLight(glm::vec3(100), glm::vec3(0), {0, 1, 0}, 0, 90)};
    const LightSampler lights(scene);
    for (float offset : {0.0f, 1e-30f, 1e-12f, 1e-6f, 1e-3f, 1e18f}) {
        for (size_t light : {0u, 1u}) {
            const LightSample sample = lights.samplePunctual(light, {offset, 0, 0});
            EXPECT_TRUE(isFinite(sample.radiance) && isFinite(sample.towardLight)) << offset;
        }
    }
    EXPECT_EQ(lights.samplePunctual(0, glm::vec3(0)).pdf, 0.0f);
}

// The floor's box has a half diagonal of sqrt(2), so the sphere's cross-section is 2 pi.
TEST(Lights, PowerByKind) {
    const auto powers = [](auto&& change) {
        Scene scene;
        addFloor(scene, lambert(1), 2);
        change(scene);
        const LightSampler lights(scene);
        return std::pair(lights.powerPunctual(), lights.powerArea());
    };
    const glm::vec3 color(1, 2, 3);
    const auto point = powers([&](Scene& s) {
        s.lights = {pointLight(color, glm::vec3(0))};
        s.lights[0].rangeMeters = 1;
    });
    expectNear(point.first, 4 * kPi * color, 1e-6f);
    const auto sun = powers([&](Scene& s) { s.lights = {directionalLight(color, {0, -1, 0})}; });
    expectNear(sun.first, 2 * kPi * color, 1e-6f);
    EXPECT_EQ(sun.second, glm::vec3(0));

    const auto area = powers([&](Scene& s) { addCeiling(s, emitter(color), 1, 0); });
    expectNear(area.second, kPi * color, 1e-6f);
    const auto bothSides = powers([&](Scene& s) {
        Material material = emitter(color);
        material.doubleSided = true;
        addCeiling(s, material, 1, 0);
    });
    expectNear(bothSides.second, 2 * kPi * color, 1e-6f);
    const auto veil = powers([&](Scene& s) {
        Material material = emitter(color);
        material.alphaMode = AlphaMode::blend;
        material.baseColor.a = 0.25f;
        addCeiling(s, material, 1, 0);
    });
    expectNear(veil.second, 0.25f * kPi * color, 1e-6f);
    const auto sky = powers([&](Scene& s) { s.environment = Environment{Image(8, 4, color)}; });
    expectNear(sky.second, 4 * kPi * 2 * kPi * color, 1e-5f);
    EXPECT_EQ(sky.first, glm::vec3(0));
}

TEST(Lights, DarknessIsEmpty) {
    Scene scene;
    addFloor(scene, lambert(1), 2);
    const LightSampler lights(scene);
    EXPECT_TRUE(lights.empty());
    EXPECT_FALSE(lights.hasArea());
    EXPECT_EQ(lights.sampleArea({0, 1, 0}, 0.5f, {0.5f, 0.5f}).pdf, 0.0f);
    EXPECT_EQ(lights.sampleEnvironmentPdf({0, 1, 0}), 0.0f);
    EXPECT_EQ(lights.environmentRadiance({0, 1, 0}), glm::vec3(0));
    EXPECT_EQ(lights.emitPhoton(0, 10, 1).fluxWatts, glm::vec3(0));

    scene.environment = Environment{Image(4, 2, glm::vec3(0))};
    const LightSampler blackSky(scene);
    EXPECT_TRUE(blackSky.empty());
    EXPECT_EQ(blackSky.sampleArea({0, 1, 0}, 0.5f, {0.5f, 0.5f}).pdf, 0.0f);
    EXPECT_EQ(blackSky.emitPhoton(0, 10, 1).fluxWatts, glm::vec3(0));
    EXPECT_TRUE(LightSampler(Scene{}).empty());
}

glm::dvec3 fluxSum(const LightSampler& lights, uint64_t count, uint64_t seed) {
    glm::dvec3 sum(0);
    for (uint64_t i = 0; i < count; ++i) sum += glm::dvec3(lights.emitPhoton(i, count, seed).fluxWatts);
    return sum;
}

// All kinds at once, of different colours, with a few photons and with many.
TEST(Lights, PhotonsCarryThePowerOfUntexturedLights) {
    Scene scene;
    addFloor(scene, emitter({0, 0, 3}), 4);
    addCeiling(scene, emitter({5, 4, 3}), 1, 2);
    Material glow = emitter({0.5f, 2, 0.5f});
    glow.doubleSided = true;
    glow.unlit = true;
    addCeiling(scene, glow, 1, 3);
    scene.lights = {pointLight({10, 0, 0}, {0, 1, 0}), spotLight({0, 30, 10}, {0, 1, 0}, {1, 0, 0}, 10, 20),
                    directionalLight({1, 1, 0.5f}, {0, 0, 1}), pointLight(glm::vec3(0), {0, 1, 0})};
    scene.environment = Environment{Image(16, 8, {0.1f, 0.2f, 0.3f})};
    const LightSampler lights(scene);
    const glm::vec3 power = lights.powerPunctual() + lights.powerArea();
    for (uint64_t count : {1000u, 4097u, 100'000u}) {
        for (uint64_t seed : {1u, 2u}) expectNear(fluxSum(lights, count, seed), power, 1e-5f);
    }
}

// Lights that are due a fraction of a photon: right on average over seeds. The weak light, a tenth of a
// photon of the ten, is found in 1000 of 10,000 seeds with a standard deviation of 30; 4 of those are 12 %.
TEST(Lights, WeakLightsAreNotLost) {
    Scene scene;
    scene.lights = {pointLight({99, 0, 0}, glm::vec3(0)), pointLight({0, 0, 1}, glm::vec3(0))};
    scene.lights[1].intensity.z = 0.01f / 0.99f * 99 * 0.2126f / 0.0722f;  // a hundredth of the luminance
    const LightSampler lights(scene);
    glm::dvec3 sum(0);
    for (uint64_t seed = 0; seed < 10'000; ++seed) sum += fluxSum(lights, 10, seed);
    const glm::dvec3 mean = sum / 1e4;
    EXPECT_NEAR(mean.z, lights.powerPunctual().z, 0.12 * lights.powerPunctual().z);
    EXPECT_NEAR(mean.x, lights.powerPunctual().x, 1e-5 * lights.powerPunctual().x);
}

TEST(Lights, AHundredThousandTrianglesKeepTheirProbabilities) {
    Scene scene;
    addSurface(scene, emitter(glm::vec3(1)));
    constexpr int kSide = 224;  // 100,352 triangles whose areas span six orders of magnitude
    const glm::vec2 uv[3] = {};
    for (int i = 0; i < kSide * kSide * 2; ++i) {
        const float size = std::pow(10.0f, -3.0f * float(i % 100) / 99.0f);
        const glm::vec3 corner(float(i % kSide) * 2, 0, float(i / kSide) * 2);
        const glm::vec3 corners[] = {corner, corner + glm::vec3(0, 0, size), corner + glm::vec3(size, 0, 0)};
        addTriangle(scene, corners, uv);
    }
    const LightSampler lights(scene);
    const glm::vec3 point(100, 50, 100);
    // Monte Carlo over the choice alone: the mean of 1 / (area pdf) is the total area.
    double area = 0;
    constexpr int kSamples = 20'000;
    for (int i = 0; i < kSamples; ++i) {
        const LightSample sample = lights.sampleArea(point, (float(i) + 0.5f) / kSamples, {0.3f, 0.6f});
        ASSERT_GT(sample.pdf, 0.0f);
        const double toArea = -sample.towardLight.y / (double(sample.distance) * sample.distance);
        area += 1.0 / (sample.pdf * toArea) / kSamples;
    }
    EXPECT_NEAR(area, lights.powerArea().x / kPi, 1e-4 * lights.powerArea().x);
}

TEST(Lights, SidesOfAnEmitter) {
    Scene scene;
    addCeiling(scene, emitter(glm::vec3(1)), 1, 0);
    const LightSampler oneSided(scene);
    scene.materials[0].doubleSided = true;
    const LightSampler twoSided(scene);
    const glm::vec3 above(0, 1, 0), below(0, -1, 0);
    EXPECT_GT(oneSided.sampleArea(below, 0.1f, {0.2f, 0.3f}).pdf, 0.0f);
    EXPECT_EQ(oneSided.sampleArea(above, 0.1f, {0.2f, 0.3f}).pdf, 0.0f);
    EXPECT_GT(twoSided.sampleArea(above, 0.1f, {0.2f, 0.3f}).pdf, 0.0f);
    EXPECT_EQ(twoSided.sampleArea(above, 0.1f, {0.2f, 0.3f}).radiance, glm::vec3(1));
    int up = 0;
    for (int i = 0; i < 1000; ++i) {
        EXPECT_LT(oneSided.emitPhoton(i, 1000, 1).direction.y, 0.0f);
        up += twoSided.emitPhoton(i, 1000, 1).direction.y > 0;
    }
    EXPECT_NEAR(up, 500, 2);  // the sides alternate systematically within each of the two triangles
    // On the light and in its plane there is nothing to see.
    EXPECT_EQ(oneSided.sampleArea({3, 0, 0}, 0.1f, {0.2f, 0.3f}).pdf, 0.0f);
}

// Columns of code 255 and 0 under bilinear lookups: exactly half of the light.
TEST(Lights, TexturedEmitters) {
    Scene scene;
    std::vector<uint8_t> stripes(64 * 64, 0);
    for (size_t i = 0; i < stripes.size(); i += 2) stripes[i] = 255;
    Material material = emitter(glm::vec3(4));
    material.emissionTexture.image = addGreyImage(scene, 64, 64, stripes);
    addCeiling(scene, material, 1, 0);
    LightSampler lights(scene);
    expectNear(lights.powerArea(), glm::vec3(2 * kPi), 0.01f);  // 1024 samples a triangle
    // Photons average their own places: sd of the flux / mean = .58 over 10,000 of them gives .6 %.
    expectNear(fluxSum(lights, 10'000, 1), glm::vec3(2 * kPi), 0.02f);
}

// One bright texel among black ones, that 1024 samples a triangle of 1800 texels often miss.
TEST(Lights, NoEmitterIsOverlooked) {
    for (int bright = -1; bright < 60 * 60; bright += 37) {
        Scene scene;
        std::vector<uint8_t> texels(60 * 60, 0);
        if (bright >= 0) texels[bright] = 255;
        Material material = emitter(glm::vec3(4));
        material.emissionTexture.image = addGreyImage(scene, 60, 60, texels);
        material.emissionTexture.nearest = true;
        addCeiling(scene, material, 1, 0);
        EXPECT_EQ(LightSampler(scene).hasArea(), bright >= 0) << bright;
    }
}

TEST(Lights, ChoiceSkipsWhatHasNoWeight) {
    const double weights[] = {0, 1, 0, 3, 0};
    const DiscreteDistribution distribution(weights);
    EXPECT_EQ(distribution.choose(0).index, 1u);
    EXPECT_EQ(distribution.choose(0.2499).index, 1u);
    EXPECT_EQ(distribution.choose(0.25).index, 3u);
    EXPECT_EQ(distribution.choose(std::nextafter(1.0, 0.0)).index, 3u);
    EXPECT_EQ(distribution.choose(1.0).index, 3u);  // what rounding may ask for
    EXPECT_DOUBLE_EQ(distribution.choose(0.625).within, 0.5);
    EXPECT_EQ(distribution.choose(0.9, 0, 3).index, 1u);
}

}  // namespace
}  // namespace phat
