// The CPU's full evaluation of PHATextures: exact where it must be, else against the path tracer.

#include "core/render/phat_gather.h"

#include <gtest/gtest.h>

#include "core/bake/bake.h"
#include "core/render/path_tracer.h"
#include "support/scene_builder.h"

namespace phat {
namespace {

using namespace test;

/// A baked scene and rays from one eye.
struct World {
    explicit World(const Scene& s, uint64_t texels = 60'000) : scene(s), rays(scene), lights(scene) {
        BakeSettings settings;
        settings.atlas.texelBudget = texels;
        settings.photons.count = 100'000;
        baked = bake(scene, settings, silent);
    }
    World(const World&) = delete;
    World& operator=(const World&) = delete;

    Integrator gather(const PhatGatherSettings& settings) const {
        return phatGather({rays, lights, baked.atlas, baked.points, baked.phatexture}, settings);
    }
    Integrator gather(Component component) const {
        PhatGatherSettings settings;
        settings.component = component;
        return gather(settings);
    }

    const Scene scene;
    const RayScene rays;
    const LightSampler lights;
    SilentProgress silent;
    Bake baked;
};

Material metal(float roughness) {
    Material material;
    material.baseColor = glm::vec4(0.8f, 0.8f, 0.8f, 1);
    material.roughness = roughness;
    return material;
}

// Grey walls of different shades, a metal floor, a lamp under the ceiling.
Scene room(const Material& floor, const Material& wall) {
    Scene scene;
    addRoom(scene, wall, glm::vec3(2));
    scene.materials[scene.surfaces[0].material].baseColor = {0.8f, 0.2f, 0.1f, 1};  // x = 0
    scene.materials[scene.surfaces[2].material] = floor;                            // y = 0
    addQuad(scene, emitter(glm::vec3(8)), {0.7f, 1.95f, 0.7f}, {0.6f, 0, 0}, {0, 0, 0.6f});
    return scene;
}

Ray rayToward(glm::vec3 target) {
    const glm::vec3 eye(1.6f, 0.9f, 1.7f);
    return {eye, glm::normalize(target - eye)};
}

constexpr int kPoints = 8;  // a side, on the floor from .2 to 1.6 m

Ray rayToFloor(int i) {
    return rayToward({0.2f + 0.2f * float(i % kPoints), 0, 0.2f + 0.2f * float(i / kPoints)});
}

/// Mean of the luminances over the places, and of the absolute differences to the expected ones.
struct Comparison {
    double mean = 0, expected = 0, meanDifference = 0;
};

Comparison compare(const World& world, const PhatGatherSettings& settings, int pathSamples) {
    const Integrator gather = world.gather(settings);
    const Integrator path = pathTracer(world.rays, world.lights, settings.component);
    Comparison result;
    for (int i = 0; i < kPoints * kPoints; ++i) {
        PixelSample sample{Rng(hashOf(2, uint64_t(i)))};
        const double value = double(luminance(gather(rayToFloor(i), sample)));
        double expected = 0;
        for (int j = 0; j < pathSamples; ++j)
            expected += double(luminance(path(rayToFloor(i), sample))) / pathSamples;
        result.mean += value;
        result.expected += expected;
        result.meanDifference += std::abs(value - expected);
    }
    return result;
}

// All PHATexels say 1: a lobe sees 1, whatever their number, weights and visibility.
TEST(PhatGather, FurnaceIsExact) {
    for (const float roughness : {0.1f, 0.4f, 1.0f}) {
        Material floor = metal(roughness);
        floor.clearcoat = 0.6f;
        floor.clearcoatRoughness = 0.3f;
        World world(room(floor, lambert(0.5f)), 10'000);
        for (std::vector<PhatexelLayer>* source :
             {&world.baked.phatexture.indirect, &world.baked.phatexture.area})
            for (PhatexelLayer& layer : *source)
                for (PackedPhatexel& packed : layer.texels) packed.radiance = packRgb9e5(glm::vec3(1));
        for (const float radius : {0.0f, 0.3f}) {
            for (const bool trace : {false, true}) {
                for (const Component component : {Component::glossyIndirect, Component::direct}) {
                    const Integrator gather = world.gather({radius, trace, component});
                    for (int i = 0; i < kPoints * kPoints; i += 5) {
                        const Ray ray = rayToFloor(i);
                        const Hit hit = world.rays.closestHit(ray.origin, ray.direction);
                        const SurfacePoint point = surfaceAt(world.scene, hit, ray.direction);
                        PixelSample sample{Rng(1)};
                        EXPECT_NEAR(gather(ray, sample).x,
                                    reflectance(point.brdf, point.shading.toLocal(-ray.direction)).x, 1e-5f)
                            << roughness << " " << radius << " " << trace << " " << int(component);
                    }
                }
            }
        }
    }
}

// Each lobe has at least 16 samples, and each of those the noise of 8 paths; neighbouring places share
// samples, so the mean of 64 places gains less than a factor of 8.
TEST(PhatGather, GlossyFloorMatchesThePathTracer) {
    for (const float roughness : {0.25f, 0.5f}) {
        const World world(room(metal(roughness), lambert(0.6f)));
        for (const bool trace : {false, true}) {
            const Comparison found = compare(world, {0, trace, Component::glossyIndirect}, 400);
            EXPECT_NEAR(found.mean, found.expected, 0.05 * found.expected) << roughness << " " << trace;
            EXPECT_LT(found.meanDifference, 0.15 * found.expected) << roughness << " " << trace;
        }
    }
}

// The lamp's reflection in the floor, its diffuse light and its shadow.
TEST(PhatGather, LampMatchesThePathTracer) {
    Material plastic;
    plastic.baseColor = glm::vec4(0.5f, 0.5f, 0.5f, 1);
    plastic.metallic = 0;
    plastic.roughness = 0.4f;
    for (const Material& floor : {metal(0.4f), plastic}) {
        const World world(room(floor, lambert(0.6f)), 120'000);
        const Comparison found = compare(world, {0, false, Component::direct}, 1000);
        EXPECT_NEAR(found.mean, found.expected, 0.05 * found.expected);
        EXPECT_LT(found.meanDifference, 0.1 * found.expected);
    }
}

// One point light and nothing else, in closed form.
TEST(PhatGather, PointLightIsExact) {
    Scene scene;
    addFloor(scene, lambert(1), 4);
    scene.lights = {pointLight(glm::vec3(100), {0, 1, 0})};
    const World world(scene, 4'000);
    PixelSample sample{Rng(1)};
    const Ray ray{{0.5f, 1, 0}, glm::normalize(glm::vec3(-0.5f, -1, 0))};
    EXPECT_NEAR(world.gather(Component::all)(ray, sample).x, 100 / kPi, 1e-3f);
    EXPECT_EQ(world.gather(Component::indirect)(ray, sample).x, 0);
}

// Over a fixed radius the paper's filter smears what is near; reconnected samples do not.
TEST(PhatGather, ReconnectionBeatsTheFixedFilter) {
    Scene scene = room(metal(0.25f), lambert(0.6f));
    // Stripes that stand on the floor, a hand's breadth apart.
    for (int i = 0; i < 6; ++i) {
        Material stripe = lambert(i % 2 == 0 ? 0.9f : 0.05f);
        stripe.doubleSided = true;
        addQuad(scene, stripe, {0.4f + 0.2f * float(i), 0, 0.45f}, {0.2f, 0, 0}, {0, 0.5f, 0});
    }
    const World world(scene);
    const Comparison fixed = compare(world, {0.4f, false, Component::glossyIndirect}, 400);
    const Comparison reconnected = compare(world, {0, false, Component::glossyIndirect}, 400);
    EXPECT_LT(reconnected.meanDifference, 0.8 * fixed.meanDifference);
}

// Pieces of two surfaces may share a chart, and have a wall between them.
TEST(PhatGather, LightOfAnotherSurfaceStaysThere) {
    Scene scene = room(metal(0.4f), Material());
    const uint32_t first = uint32_t(scene.surfaces.size());
    for (const float x : {0.6f, 0.72f})
        addQuad(scene, metal(0.4f), {x, 0.2f, 0.8f}, {0, 0, 0.1f}, {0.1f, 0, 0});
    World world(scene);
    const uint32_t triangle = scene.surfaces[first].firstTriangle;
    ASSERT_EQ(world.baked.atlas.triangleChart[triangle], world.baked.atlas.triangleChart[triangle + 2]);

    const auto reflected = [&](float radiusMeters) {
        PhatGatherSettings settings;
        settings.component = Component::glossyIndirect;
        settings.radiusMeters = radiusMeters;
        const Integrator gather = world.gather(settings);
        PixelSample sample{Rng(1)};
        return gather(rayToward({0.65f, 0.2f, 0.85f}), sample);
    };
    const glm::vec3 before[] = {reflected(0), reflected(0.2f)};
    EXPECT_GT(luminance(before[0]), 0.0f);
    for (PhatexelLayer& layer : world.baked.phatexture.indirect)
        for (size_t i = 0; i < layer.texels.size(); ++i)
            if (world.baked.points.valid(i) &&
                scene.triangleSurface[world.baked.points.triangle[i]] == first + 1)
                layer.texels[i].radiance = packRgb9e5(glm::vec3(1000));
    EXPECT_EQ(reflected(0), before[0]);
    EXPECT_EQ(reflected(0.2f), before[1]);
}

TEST(PhatGather, ComponentsAddUp) {
    Material floor = metal(0.5f);
    floor.metallic = 0.5f;
    const World world(room(floor, lambert(0.6f)), 10'000);
    const auto value = [&](Component component) {
        PixelSample sample{Rng(1)};
        return world.gather(component)(rayToFloor(20), sample).x;
    };
    EXPECT_NEAR(value(Component::all), value(Component::direct) + value(Component::indirect), 1e-5f);
    EXPECT_NEAR(value(Component::indirect),
                value(Component::glossyIndirect) + value(Component::diffuseIndirect), 1e-5f);
    EXPECT_GT(value(Component::diffuseIndirect), 0);
    EXPECT_GT(value(Component::glossyIndirect), 0);
}

}  // namespace
}  // namespace phat
