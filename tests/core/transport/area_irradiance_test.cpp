#include "core/transport/area_irradiance.h"

#include <gtest/gtest.h>

#include "core/base/hemisphere_map.h"
#include "support/scene_builder.h"

namespace phat {
namespace {

using namespace test;

const glm::vec3 kUp(0, 1, 0);

// A lamp of a square metre, two metres above a floor, and half way a rod of `thickness` below its middle.
Scene floorBelowLampAndRod(float thickness) {
    Scene scene;
    addFloor(scene, lambert(0.5f), 20);
    addCeiling(scene, emitter(glm::vec3(5)), 1, 2);
    Material rod = lambert(0.5f);
    rod.doubleSided = true;
    addQuad(scene, rod, {-thickness / 2, 1, -5}, {thickness, 0, 0}, {0, 0, 10});
    return scene;
}

struct Estimates {
    double mean = 0, variance = 0, reported = 0;
    uint64_t rays = 0;
};

Estimates estimatesAt(const Scene& scene, glm::vec3 position, ShadowRays shadowRays, int count) {
    const RayScene rays(scene);
    const LightSampler lights(scene);
    const AreaIrradianceSampler sampler({rays, lights});
    Estimates found;
    double squares = 0;
    for (int i = 0; i < count; ++i) {
        const IrradianceEstimate estimate =
            sampler.areaIrradiance(position, kUp, {8, 6}, shadowRays, Rng(hashOf(uint64_t(i))), found.rays);
        found.mean += estimate.value.x / count;
        squares += square(double(estimate.value.x)) / count;
        found.reported += estimate.variance / count;
    }
    found.variance = squares - square(found.mean);
    return found;
}

TEST(AreaIrradianceSampler, SparseShadowRaysHaveTheSameMean) {
    constexpr int kSeeds = 20'000;
    for (const float thickness : {0.002f, 0.05f, 1.5f})  // a thread, a rod, and what hides all of the lamp
        for (const glm::vec3 position :
             {glm::vec3(0.1f, 0, 0), glm::vec3(0.7f, 0, 0.2f), glm::vec3(3, 0, 0)}) {
            const Scene scene = floorBelowLampAndRod(thickness);
            const Estimates all = estimatesAt(scene, position, ShadowRays::all, kSeeds);
            const Estimates sparse = estimatesAt(scene, position, ShadowRays::sparse, kSeeds);
            const double error = std::sqrt((all.variance + sparse.variance) / kSeeds);
            EXPECT_NEAR(sparse.mean, all.mean, 4 * error + 1e-6) << thickness << ' ' << position.x;
            // What it says of its own noise is the noise.
            EXPECT_NEAR(sparse.reported, sparse.variance, 0.1 * sparse.variance + 1e-9);
        }
}

TEST(AreaIrradianceSampler, SparseShadowRaysAreFewAndAddNoNoiseInFullLight) {
    const Scene scene = floorBelowLampAndRod(0.002f);
    const glm::vec3 inFullLight(3, 0, 0);
    constexpr int kSeeds = 5000;
    const Estimates all = estimatesAt(scene, inFullLight, ShadowRays::all, kSeeds);
    const Estimates sparse = estimatesAt(scene, inFullLight, ShadowRays::sparse, kSeeds);
    // Of 48 light samples all reach the floor, and of 24 cosine-weighted rays few come near the lamp.
    EXPECT_GT(all.rays, uint64_t(48 * kSeeds));
    EXPECT_LT(all.rays, uint64_t(52 * kSeeds));
    EXPECT_LT(sparse.rays, uint64_t(16 * kSeeds));
    EXPECT_NEAR(sparse.variance, all.variance, 0.1 * all.variance);
}

TEST(ShiningBounds, MissNoRayThatMeetsALight) {
    for (const int lamps : {1, 3, 12}) {  // of more than eight, one box holds all
        Scene scene;
        addRoom(scene, lambert(0.5f), {4, 3, 5});
        Rng rng(hashOf(uint64_t(lamps)));
        for (int i = 0; i < lamps; ++i) {
            const glm::vec3 corner(3 * rng.uniform(), 1 + rng.uniform(), 4 * rng.uniform());
            // Parallel to a wall: its box is flat.
            addQuad(scene, emitter(glm::vec3(1)), corner, {0.3f, 0, 0}, i % 2 ? kUp : glm::vec3(0, 0, 0.4f));
        }
        const RayScene rays(scene);
        const ShiningBounds bounds(rays);
        int met = 0, ruledOut = 0;
        constexpr int kRays = 50'000;
        for (int i = 0; i < kRays; ++i) {
            const float x = rng.uniform();
            const glm::vec3 origin(4 * x, 3 * rng.uniform(), 5 * rng.uniform());
            const glm::vec2 square = rng.uniform2();
            glm::vec3 direction = squareToHemisphere(square) * (i % 2 ? 1.0f : -1.0f);
            if (i % 16 == 0) direction = glm::vec3(0, i % 32 ? 1 : -1, 0);
            const Ray ray{origin, direction};
            const Hit hit = rays.closestHit(ray.origin, ray.direction);
            const bool shines = hit && scene.materialOf(hit.triangle).emission.x > 0;
            met += shines;
            ruledOut += !bounds.mayMeet(ray);
            EXPECT_TRUE(!shines || bounds.mayMeet(ray)) << lamps << ' ' << i;
        }
        EXPECT_GT(met, kRays / 1000);
        EXPECT_GT(ruledOut, kRays / 10);
    }
}

}  // namespace
}  // namespace phat
