// The path tracer against closed forms, quadrature and a brute-force twin without any of its techniques.

#include "core/transport/path.h"

#include <gtest/gtest.h>

#include "support/penumbra.h"
#include "support/scene_builder.h"

namespace phat {
namespace {

using namespace test;

struct Mean {
    double value = 0;
    double standardError = 0;
};

template <typename Draw>
Mean meanOf(int count, const Draw& draw) {
    double sum = 0, squares = 0;
    for (int i = 0; i < count; ++i) {
        const double x = draw(i);
        sum += x;
        squares += x * x;
    }
    const double mean = sum / count;
    return {mean, std::sqrt(std::max(squares / count - mean * mean, 0.0) / (count - 1))};
}

// Four standard errors: a correct estimator fails once in 16,000 seeds. `precision` keeps the test sharp.
void expectMean(const Mean& mean, double expected, double precision) {
    EXPECT_NEAR(mean.value, expected, 4 * mean.standardError + 1e-6 * expected);
    EXPECT_LT(mean.standardError, precision * expected) << "the test tells nothing";
}

/// A scene with its helpers, and one point on it.
struct World {
    explicit World(const Scene& s) : scene(s), rays(scene), lights(scene) {}
    World(const World&) = delete;
    World& operator=(const World&) = delete;

    SurfacePoint seenFrom(glm::vec3 origin, glm::vec3 direction) const {
        return surfaceAt(scene, rays.closestHit(origin, direction), direction);
    }
    Mean reflected(const SurfacePoint& point, glm::vec3 towardEye, int maxBounces, int count) const {
        Rng rng(1);
        uint64_t rayCount = 0;
        return meanOf(count, [&](int) {
            return double(traceReflected({rays, lights}, {point, towardEye}, maxBounces, rng, rayCount).x);
        });
    }

    const Scene scene;
    const RayScene rays;
    const LightSampler lights;
};

const glm::vec3 kDown(0, -1, 0), kUp(0, 1, 0);

// 100 cd a metre above a white Lambert plane: 100 / pi.
TEST(Path, PointLightOverAPlane) {
    Scene scene;
    addFloor(scene, lambert(1), 4);
    scene.lights = {pointLight(glm::vec3(100), {0, 1, 0})};
    const World world(scene);
    const SurfacePoint point = world.seenFrom({0, 0.5f, 0}, kDown);
    const Mean mean = world.reflected(point, kUp, 4, 10);
    EXPECT_NEAR(mean.value, 31.831, 1e-3);

    addFloor(scene, lambert(0), 0.1f, 0.7f);  // in between
    const World shadowed(scene);
    EXPECT_EQ(shadowed.reflected(shadowed.seenFrom({0, 0.5f, 0}, kDown), kUp, 4, 10).value, 0);
}

TEST(Path, PenumbraOfADiscBehindAStraightEdge) {
    constexpr float kRadius = 0.00465f;
    const World world(floorBehindEdge(kRadius)), sharp(floorBehindEdge(0));
    for (const float offset : {-1.2f, -0.9f, -0.5f, -0.2f, 0.0f, 0.3f, 0.6f, 0.9f, 1.2f}) {
        const glm::vec3 above(offset * std::tan(kRadius) * kEdgeHeight, 0.5f, 0.1f);
        const SurfacePoint point = world.seenFrom(above, kDown);
        const double seen = discFraction(double(offset));
        const Mean mean = world.reflected(point, kUp, 1, 40'000);
        EXPECT_NEAR(mean.value * double(kPi), seen, 4 * double(kPi) * mean.standardError + 1e-4) << offset;
        EXPECT_LT(mean.standardError, 0.002);
        if (offset != 0) {
            EXPECT_NEAR(sharp.reflected(point, kUp, 1, 1).value * double(kPi), offset > 0 ? 1 : 0, 1e-5);
        }
    }
}

// The numbers of one choice among many lights are also those of the point on the disc.
TEST(Path, PenumbraAmongManyLights) {
    constexpr float kRadius = 0.00465f;
    Scene scene = floorBehindEdge(kRadius);
    for (int i = 0; i < 5; ++i) scene.lights.push_back(pointLight(glm::vec3(0.1f), {0, 1, float(i)}));
    const World world(scene);
    scene.lights.erase(scene.lights.begin());
    const World lamps(scene);
    const glm::vec3 above(0.4f * std::tan(kRadius) * kEdgeHeight, 0.5f, 0.1f);
    const SurfacePoint point = world.seenFrom(above, kDown);
    const Mean all = world.reflected(point, kUp, 1, 40'000), others = lamps.reflected(point, kUp, 1, 40'000);
    const double error = std::hypot(all.standardError, others.standardError);
    EXPECT_NEAR((all.value - others.value) * double(kPi), discFraction(0.4), 4 * double(kPi) * error);
    EXPECT_LT(error, 0.003);
}

// Share of the cosine-weighted hemisphere that a square of side `size`, centred `height` above, takes.
// source: Howell, "A Catalog of Radiation Heat Transfer Configuration Factors", B-3.
double squareFraction(double size, double height) {
    const double a = size / 2 / height, root = std::sqrt(1 + a * a);
    return 4 * a / (double(kPi) * root) * std::atan(a / root);
}

Scene floorUnderSquare(const Material& floor, float size, float nit) {
    Scene scene;
    addFloor(scene, floor, 4);
    addCeiling(scene, emitter(glm::vec3(nit)), size, 1);
    return scene;
}

TEST(Path, SquareLampOverAPlane) {
    EXPECT_NEAR(5 * squareFraction(1, 1), 1.1973, 1e-4);
    for (const float size : {0.02f, 1.0f, 50.0f}) {
        const World world(floorUnderSquare(lambert(1), size, 5));
        const SurfacePoint point = world.seenFrom({0, 0.5f, 0}, kDown);
        expectMean(world.reflected(point, kUp, 3, 40'000), 5 * squareFraction(size, 1), 0.01);
    }
}

TEST(Path, AreaIrradianceOfASquareLamp) {
    for (const float size : {0.02f, 1.0f, 50.0f}) {
        const World world(floorUnderSquare(lambert(1), size, 5));
        uint64_t rayCount = 0;
        double reported = 0;
        constexpr int kSeeds = 4000;
        const Mean mean = meanOf(kSeeds, [&](int seed) {
            const IrradianceEstimate estimate = areaIrradiance({world.rays, world.lights}, glm::vec3(0), kUp,
                                                               {8, 2}, Rng(uint64_t(seed)), rayCount);
            reported += estimate.variance / kSeeds;
            return double(estimate.value.x);
        });
        expectMean(mean, 5 * double(kPi) * squareFraction(size, 1), 0.005);
        // What it says of its own noise is the noise.
        const double actual = mean.standardError * mean.standardError * kSeeds;
        EXPECT_NEAR(reported, actual, 0.2 * actual + 1e-10) << size;
        EXPECT_GT(rayCount, uint64_t(16 * kSeeds));
    }
}

// A metal floor under a small and a large lamp, where one of the two techniques alone would be hopeless;
// twin: midpoint rule over the lamp.
// A flat lamp that shines from both faces of its lower side, in a case that closes it above and all around.
// What lies above its plane sees nothing of it, not even of its rim.
TEST(Path, NoLightPassesTheRimOfALampsCase) {
    Scene scene;
    const glm::vec3 low(-0.325f, 2.745f, -0.2625f), size(0.65f, 0.02f, 0.525f);
    const glm::vec3 x(size.x, 0, 0), y(0, size.y, 0), z(0, 0, size.z);
    Material lamp = emitter(glm::vec3(22));
    lamp.doubleSided = true;
    addQuad(scene, lamp, low, x, z);
    Material plate = lambert(0.5f);
    plate.doubleSided = true;
    addQuad(scene, plate, low + y, z, x);
    addQuad(scene, plate, low, y, x);
    addQuad(scene, plate, low + z, x, y);
    addQuad(scene, plate, low, z, y);
    addQuad(scene, plate, low + x, y, z);
    const World world(scene);

    Rng rng(1);
    uint64_t rayCount = 0;
    double sum = 0;
    for (int i = 0; i < 20'000; ++i) {
        const float angle = 2 * kPi * rng.uniform(), away = 0.4f + 0.2f * rng.uniform();
        const glm::vec3 place(away * std::cos(angle), 2.775f, away * std::sin(angle));
        sum += areaIrradiance({world.rays, world.lights}, place, kDown, {16, 2}, Rng(uint64_t(i)), rayCount)
                   .value.x;
    }
    EXPECT_EQ(sum, 0);
    // And below it, it shines.
    EXPECT_GT(areaIrradiance({world.rays, world.lights}, {0, 1, 0}, kUp, {16, 2}, Rng(1), rayCount).value.x,
              1);
}

TEST(Path, GlossyFloorUnderSmallAndLargeLamps) {
    Material metal;
    metal.roughness = 0.3f;
    for (const float size : {0.05f, 1.5f, 8.0f}) {
        const World world(floorUnderSquare(metal, size, 1));
        const glm::vec3 towardEye = glm::normalize(glm::vec3(0.5f, 1, 0));
        const SurfacePoint point = world.seenFrom(0.5f * towardEye, -towardEye);
        constexpr int kSteps = 1200;
        double sum = 0;
        for (int i = 0; i < kSteps * kSteps; ++i) {
            const glm::vec2 place = (glm::vec2(i % kSteps, i / kSteps) + 0.5f) / float(kSteps) - 0.5f;
            const glm::vec3 to = glm::vec3(place.x * size, 1, place.y * size) - point.position;
            const float distance2 = glm::dot(to, to);
            const glm::vec3 towardLight = to / std::sqrt(distance2);
            sum += double(
                evaluateBrdf(point.brdf, point.shading.toLocal(towardEye), point.shading.toLocal(towardLight))
                    .x *
                towardLight.y / distance2);
        }
        const double expected = sum * size * size / (double(kSteps) * kSteps);
        expectMean(world.reflected(point, towardEye, 1, 100'000), expected, 0.01);
    }
}

Scene furnaceRoom(Material wall) {
    wall.emission = glm::vec3(1);
    Scene scene;
    addRoom(scene, wall, {1, 1.5f, 2});
    return scene;
}

const glm::vec3 kInside(0.4f, 0.8f, 1.1f);
const glm::vec3 kAskew = glm::normalize(glm::vec3(0.3f, -1, 0.2f));

// Albedo .5, emission 1: after n bounces 1/2 + 1/4 + ... + 1/2^n.
TEST(Path, DiffuseFurnaceIsTheGeometricSeries) {
    const World world(furnaceRoom(lambert(0.5f)));
    const SurfacePoint point = world.seenFrom(kInside, kAskew);
    EXPECT_EQ(point.emission, glm::vec3(1));
    for (int bounces : {1, 2, 3, 5, 40}) {
        SCOPED_TRACE(bounces);
        expectMean(world.reflected(point, -kAskew, bounces, 40'000), 1 - std::exp2(-bounces), 0.005);
    }
    EXPECT_EQ(world.reflected(point, -kAskew, 0, 10).value, 0);
}

TEST(Path, IncidentLightIsEmittedAndReflected) {
    const World world(furnaceRoom(lambert(0.5f)));
    const float distance = world.rays.closestHit(kInside, kAskew).distance;
    uint64_t rayCount = 0;
    const Mean mean = meanOf(10'000, [&](int seed) {
        const IncidentRadiance light =
            traceIncident({world.rays, world.lights}, {kInside, kAskew}, {4, 40}, Rng(uint64_t(seed)));
        EXPECT_EQ(light.emitted, glm::vec3(1));
        EXPECT_EQ(light.distance, distance);
        rayCount += light.rays;
        return double(light.reflected.x);
    });
    expectMean(mean, 1, 0.005);
    EXPECT_GT(rayCount, 10'000u * 9) << "each of the four paths has a bounce and a shadow ray at least";
}

// Directions uniform over the hemisphere, no light samples, no roulette: slow and simple.
double bruteForce(const World& world, SurfacePoint point, glm::vec3 towardEye, int bounces, Rng& rng) {
    double radiance = 0, throughput = 1;
    for (int bounce = 0; bounce < bounces; ++bounce) {
        const glm::vec2 u = rng.uniform2();
        const float radius = std::sqrt(1 - u.x * u.x), phi = 2 * kPi * u.y;
        const glm::vec3 local(radius * std::cos(phi), radius * std::sin(phi), u.x);
        throughput *= double(evaluateBrdf(point.brdf, point.shading.toLocal(towardEye), local).x * 2 * kPi);
        const glm::vec3 direction = glm::normalize(point.shading.toWorld(local));
        const Hit hit =
            world.rays.closestHit(world.rays.offsetOrigin(point.position, point.normalGeometric), direction);
        if (!hit) return radiance + throughput * double(world.lights.environmentRadiance(direction).x);
        point = surfaceAt(world.scene, hit, direction);
        radiance += throughput * double(point.emission.x);
        towardEye = -direction;
    }
    return radiance;
}

Material plastic() {
    Material material;
    material.baseColor = glm::vec4(0.6f, 0.6f, 0.6f, 1);
    material.metallic = 0;
    material.roughness = 0.5f;
    return material;
}

Material roughMetal() {
    Material material;
    material.baseColor = glm::vec4(0.9f, 0.9f, 0.9f, 1);
    material.roughness = 0.7f;
    return material;
}

Material coatedPlastic() {
    Material material = plastic();
    material.clearcoat = 1;
    material.clearcoatRoughness = 0.6f;
    return material;
}

TEST(Path, GlossyFurnacesMatchBruteForce) {
    for (const Material& material : {roughMetal(), plastic(), coatedPlastic()}) {
        const World world(furnaceRoom(material));
        const SurfacePoint point = world.seenFrom(kInside, kAskew);
        const glm::vec3 towardEye = -kAskew;
        // One bounce sees emission 1 all round: the albedo, whose table is good to 2e-3.
        const Mean once = world.reflected(point, towardEye, 1, 40'000);
        EXPECT_NEAR(once.value, reflectance(point.brdf, point.shading.toLocal(towardEye)).x,
                    4 * once.standardError + 2e-3);
        const Mean mean = world.reflected(point, towardEye, 4, 40'000);
        Rng rng(2);
        const Mean twin = meanOf(300'000, [&](int) { return bruteForce(world, point, towardEye, 4, rng); });
        EXPECT_NEAR(mean.value, twin.value, 4 * std::hypot(mean.standardError, twin.standardError));
        EXPECT_LT(mean.standardError, 0.005 * mean.value);
        EXPECT_LT(twin.standardError, 0.01 * twin.value);
    }
}

// Roulette, light samples of two lamps and an environment, all at once.
TEST(Path, MixedLightsMatchBruteForce) {
    Scene scene;
    addFloor(scene, plastic(), 3);
    addQuad(scene, roughMetal(), {-1, 0, -1}, {2, 0, 0}, {0, 2, 0});
    addCeiling(scene, emitter({2, 2, 2}, 0.3f), 0.8f, 1.5f);
    addQuad(scene, emitter({1, 1, 1}, 0.5f), {-1, 0, -1}, {0, 1, 0}, {0, 0, 1});
    Environment sky;
    sky.radiance = Image(8, 4, glm::vec3(0.2f));
    sky.radiance.at(6, 1) = glm::vec3(3);
    scene.environment = sky;
    const World world(scene);
    const glm::vec3 direction = glm::normalize(glm::vec3(0.2f, -1, -0.4f));
    const SurfacePoint point = world.seenFrom({0, 0.6f, 0.2f}, direction);
    const Mean mean = world.reflected(point, -direction, 8, 100'000);
    Rng rng(3);
    const Mean twin = meanOf(500'000, [&](int) { return bruteForce(world, point, -direction, 8, rng); });
    EXPECT_NEAR(mean.value, twin.value, 4 * std::hypot(mean.standardError, twin.standardError));
    EXPECT_LT(mean.standardError, 0.005 * mean.value);
    EXPECT_LT(twin.standardError, 0.01 * twin.value);
}

TEST(Path, ConstantEnvironmentIsAFurnace) {
    Scene scene;
    addFloor(scene, lambert(0.7f), 2);
    scene.environment = Environment{Image(16, 8, glm::vec3(1.5f))};
    const World world(scene);
    const SurfacePoint point = world.seenFrom({0, 1, 0}, kDown);
    expectMean(world.reflected(point, kUp, 5, 40'000), 0.7 * 1.5, 0.005);

    uint64_t rayCount = 0;
    const Mean irradiance = meanOf(2000, [&](int seed) {
        const Rng rng{uint64_t(seed)};
        return double(
            areaIrradiance({world.rays, world.lights}, glm::vec3(0), kUp, {8, 2}, rng, rayCount).value.x);
    });
    expectMean(irradiance, 1.5 * double(kPi), 0.005);

    const IncidentRadiance sky = traceIncident({world.rays, world.lights}, {{0, 1, 0}, kUp}, {4, 8}, Rng(1));
    EXPECT_NEAR(sky.emitted.x, 1.5f, 1e-6f);
    EXPECT_EQ(sky.reflected, glm::vec3(0));
    EXPECT_EQ(sky.distance, kFarDistance);
}

}  // namespace
}  // namespace phat
