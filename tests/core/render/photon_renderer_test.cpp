// The two photon-map solutions against the path tracer.

#include "core/render/photon_renderer.h"

#include <gtest/gtest.h>

#include "core/transport/path.h"
#include "support/scene_builder.h"

namespace phat {
namespace {

using namespace test;

struct Mean {
    double value = 0;
    double standardError = 0;
};

/// A scene with a photon map and rays from one eye.
struct World {
    World(const Scene& s, uint64_t photonCount, int maxBounces = 16)
        : scene(s), rays(scene), lights(scene), map(trace(photonCount, maxBounces)), index(map.photons) {}
    World(const World&) = delete;
    World& operator=(const World&) = delete;

    PhotonScene photons() const { return {rays, lights, map, index}; }

    Mean meanOf(const Integrator& integrator, const Ray& ray, int count) const {
        double sum = 0, squares = 0;
        for (int i = 0; i < count; ++i) {
            PixelSample sample{Rng(hashOf(7, uint64_t(i)))};
            const double x = double(luminance(integrator(ray, sample)));
            sum += x;
            squares += x * x;
        }
        const double mean = sum / count;
        return {mean, std::sqrt(std::max(squares / count - mean * mean, 0.0) / std::max(count - 1, 1))};
    }

    /// Light along the ray after at least one reflection before the visible surface.
    Integrator pathIndirect() const {
        return [this](const Ray& ray, PixelSample& sample) {
            const Hit hit = rays.closestHit(ray.origin, ray.direction);
            const SurfacePoint point = surfaceAt(scene, hit, ray.direction);
            const glm::vec3 all =
                traceReflected({rays, lights}, {point, -ray.direction}, 17, sample.rng, sample.rays);
            return all - traceReflected({rays, lights}, {point, -ray.direction}, 1, sample.rng, sample.rays);
        };
    }

    const Scene scene;
    const RayScene rays;
    const LightSampler lights;
    const PhotonMap map;
    const PhotonIndex index;

  private:
    PhotonMap trace(uint64_t count, int maxBounces) const {
        SilentProgress silent;
        return tracePhotons(rays, lights, {count, maxBounces, 1}, silent);
    }
};

Material metal(float roughness) {
    Material material;
    material.baseColor = glm::vec4(0.8f, 0.8f, 0.8f, 1);
    material.roughness = roughness;
    return material;
}

// Grey walls, one of them metal, a lamp under the ceiling and a point light.
Scene room() {
    Scene scene;
    addRoom(scene, lambert(0.6f), glm::vec3(2));
    scene.materials[scene.surfaces[0].material] = metal(0.4f);  // x = 0
    addQuad(scene, emitter(glm::vec3(8)), {0.7f, 1.9f, 0.7f}, {0.6f, 0, 0}, {0, 0, 0.6f});
    scene.lights = {pointLight(glm::vec3(0.5f), {1.5f, 1.2f, 1.6f})};
    return scene;
}

Ray rayToward(glm::vec3 target) {
    const glm::vec3 eye(1.4f, 1.1f, 0.8f);
    return {eye, glm::normalize(target - eye)};
}

const Ray kAtWall = rayToward({1.2f, 0.9f, 2}), kAtMetal = rayToward({0, 0.8f, 1.1f});

PhotonRendererSettings settingsFor(Component component, int gatherRays = 200) {
    PhotonRendererSettings settings;
    settings.component = component;
    settings.gatherRays = gatherRays;
    return settings;
}

// The density estimate is biased by the size of its disc, here about 2 cm: 2 % of the light where it falls
// off toward the edges of the walls.
TEST(PhotonRenderer, GatheringConvergesToThePathTracer) {
    const World world(room(), 300'000);
    const Integrator gather = photonsGather(world.photons(), settingsFor(Component::indirect));
    for (const Ray& ray : {kAtWall, kAtMetal}) {
        const Mean expected = world.meanOf(world.pathIndirect(), ray, 40'000);
        const Mean mean = world.meanOf(gather, ray, 100);
        EXPECT_NEAR(mean.value, expected.value,
                    4 * std::hypot(mean.standardError, expected.standardError) + 0.02 * expected.value);
        EXPECT_LT(std::hypot(mean.standardError, expected.standardError), 0.01 * expected.value);
    }
}

// Light of one reflection more than the photons make, so that it is the gather rays' own.
TEST(PhotonRenderer, GatherRaysFindDirectLightByThemselves) {
    const World world(room(), 1'000, 0);
    const Integrator gather = photonsGather(world.photons(), settingsFor(Component::indirect));
    const Integrator twoBounces = [&](const Ray& ray, PixelSample& sample) {
        const Hit hit = world.rays.closestHit(ray.origin, ray.direction);
        const SurfacePoint point = surfaceAt(world.scene, hit, ray.direction);
        return traceReflected({world.rays, world.lights}, {point, -ray.direction}, 2, sample.rng,
                              sample.rays) -
               traceReflected({world.rays, world.lights}, {point, -ray.direction}, 1, sample.rng,
                              sample.rays);
    };
    for (const Ray& ray : {kAtWall, kAtMetal}) {
        const Mean expected = world.meanOf(twoBounces, ray, 40'000);
        const Mean mean = world.meanOf(gather, ray, 200);
        EXPECT_NEAR(mean.value, expected.value, 4 * std::hypot(mean.standardError, expected.standardError));
        EXPECT_LT(std::hypot(mean.standardError, expected.standardError), 0.01 * expected.value);
    }
}

// The k nearest of one map are one noisy answer; the mean over a patch of wall has the answer.
TEST(PhotonRenderer, LocalDensityIsRightOnAverage) {
    const World world(room(), 300'000);
    const Integrator local = photonsDirect(world.photons(), settingsFor(Component::indirect));
    double mean = 0, expected = 0;
    constexpr int kPoints = 64;
    for (int i = 0; i < kPoints; ++i) {
        const Ray ray = rayToward({0.8f + 0.1f * float(i % 8), 0.6f + 0.1f * float(i / 8), 2});
        mean += world.meanOf(local, ray, 1).value / kPoints;
        expected += world.meanOf(world.pathIndirect(), ray, 2'000).value / kPoints;
    }
    // 64 estimates of 49 photons each: 1.8 %.
    EXPECT_NEAR(mean, expected, 4 * 0.018 * expected);
}

TEST(PhotonRenderer, ComponentsAddUp) {
    Scene scene = room();
    Material coated = metal(0.5f);
    coated.metallic = 0.4f;
    coated.clearcoat = 0.7f;
    scene.materials[scene.surfaces[0].material] = coated;
    const World world(scene, 50'000);
    const auto value = [&](Component component, const Ray& ray) {
        PixelSample sample{Rng(5)};
        return photonsDirect(world.photons(), settingsFor(component))(ray, sample).x;
    };
    for (const Ray& ray : {kAtWall, kAtMetal}) {
        const float indirect = value(Component::indirect, ray);
        EXPECT_NEAR(indirect, value(Component::glossyIndirect, ray) + value(Component::diffuseIndirect, ray),
                    1e-5f * indirect);
        EXPECT_NEAR(value(Component::all, ray), value(Component::direct, ray) + indirect, 1e-5f);
        EXPECT_GT(value(Component::diffuseIndirect, ray), 0);
    }
    EXPECT_GT(value(Component::glossyIndirect, kAtMetal), 0);
    EXPECT_EQ(value(Component::glossyIndirect, kAtWall), 0);
}

// Albedo .5, emission 1: all light is 2, direct light (with what shines) 1.5.
TEST(PhotonRenderer, FurnaceRoom) {
    Material wall = lambert(0.5f);
    wall.emission = glm::vec3(1);
    Scene scene;
    addRoom(scene, wall, {1, 1.5f, 2});
    const World world(scene, 300'000);
    const Ray ray{{0.4f, 0.8f, 1.1f}, glm::normalize(glm::vec3(0.3f, -1, 0.2f))};
    const Mean direct =
        world.meanOf(photonsGather(world.photons(), settingsFor(Component::direct)), ray, 2'000);
    EXPECT_NEAR(direct.value, 1.5, 4 * direct.standardError + 1e-6);
    const Mean all = world.meanOf(photonsGather(world.photons(), settingsFor(Component::all)), ray, 200);
    EXPECT_NEAR(all.value, 2, 4 * all.standardError + 0.02);
    EXPECT_LT(all.standardError, 0.02);
}

TEST(PhotonRenderer, RaysThatLeaveSeeTheSky) {
    Scene scene;
    addFloor(scene, lambert(0.5f), 1);
    scene.environment = Environment{Image(8, 4, glm::vec3(3))};
    const World world(scene, 1'000);
    const Ray up{{0, 1, 0}, {0, 1, 0}};
    PixelSample sample{Rng(1)};
    EXPECT_NEAR(photonsGather(world.photons(), settingsFor(Component::all))(up, sample).x, 3, 1e-5f);
    EXPECT_EQ(photonsGather(world.photons(), settingsFor(Component::indirect))(up, sample).x, 0);
}

}  // namespace
}  // namespace phat
