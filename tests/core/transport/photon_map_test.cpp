#include "core/transport/photon_map.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cstring>

#include "support/scene_builder.h"

namespace phat {
namespace {

using namespace test;

PhotonMap trace(const Scene& scene, uint64_t count, int maxBounces = 16, uint64_t seed = 1) {
    const RayScene rays(scene);
    const LightSampler lights(scene);
    SilentProgress progress;
    return tracePhotons(rays, lights, {count, maxBounces, seed}, progress);
}

// A glossy, coloured, leaky room: five of the six walls, every material parameter in use.
Scene leakyRoom() {
    Scene scene;
    Material wall;
    wall.baseColor = {0.8f, 0.5f, 0.3f, 1};
    wall.metallic = 0.3f;
    wall.roughness = 0.4f;
    wall.clearcoat = 0.5f;
    wall.clearcoatRoughness = 0.2f;
    addRoom(scene, wall, {2, 3, 4});
    for (size_t i = 0; i < 6; ++i)
        scene.positions[scene.positions.size() - 1 - i] *= 0.7f;  // the last wall shrinks
    addCeiling(scene, emitter({3, 2, 1}), 0.5f, 2.5f);
    scene.lights = {pointLight({5, 10, 5}, {1, 1, 1})};
    scene.lights[0].rangeMeters = 3;
    return scene;
}

TEST(PhotonMap, EveryWattIsAccountedFor) {
    const PhotonMap map = trace(leakyRoom(), 50'000);
    const PhotonStats& stats = map.stats;
    EXPECT_EQ(stats.emitted, 50'000u);
    EXPECT_EQ(stats.stored, map.photons.size());
    EXPECT_GT(stats.stored, stats.emitted);
    for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(stats.emittedWatts[c], stats.absorbedWatts[c] + stats.escapedWatts[c],
                    1e-9 * stats.emittedWatts[c]);
        EXPECT_GT(stats.absorbedWatts[c], 0);
        EXPECT_GT(stats.escapedWatts[c], 0);
    }
    for (const Photon& photon : map.photons) ASSERT_GE(glm::dot(photon.towardOrigin, photon.normal), 0.0f);
}

// A metal's BRDF is symmetric and its samples weigh less than 1: roulette keeps the brightest channel where
// it was.
TEST(PhotonMap, RouletteKeepsTheFlux) {
    Scene scene;
    Material wall;
    wall.baseColor = {0.9f, 0.5f, 0.1f, 1};
    wall.roughness = 0.5f;
    addRoom(scene, wall, glm::vec3(1));
    scene.lights = {pointLight(glm::vec3(1, 3, 2), {0.2f, 0.4f, 0.6f})};
    const PhotonMap map = trace(scene, 20'000);
    EXPECT_GT(map.photons.size(), 40'000u);
    const float emitted = 3 * 4 * kPi / 20'000;
    for (const Photon& photon : map.photons)
        ASSERT_NEAR(maxComponent(photon.fluxWatts), emitted, 1e-4f * emitted);
}

TEST(PhotonMap, SameBytesForAnyNumberOfThreads) {
    const Scene scene = leakyRoom();
    std::vector<PhotonMap> maps;
    for (int threads : {1, 2, 8}) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, size_t(threads));
        maps.push_back(trace(scene, 30'000));
    }
    for (size_t i : {1u, 2u}) {
        ASSERT_EQ(maps[i].photons.size(), maps[0].photons.size());
        for (size_t p = 0; p < maps[0].photons.size(); ++p) {
            const Photon &a = maps[0].photons[p], &b = maps[i].photons[p];
            // Up to the flags, whose padding has no value.
            ASSERT_EQ(std::memcmp(&a, &b, offsetof(Photon, firstHit)), 0) << p;
            ASSERT_TRUE(a.firstHit == b.firstHit && a.punctual == b.punctual && a.backFace == b.backFace)
                << p;
        }
        EXPECT_EQ(maps[i].stats.absorbedWatts, maps[0].stats.absorbedWatts);
        EXPECT_EQ(maps[i].stats.escapedWatts, maps[0].stats.escapedWatts);
    }
}

TEST(PhotonMap, DarknessHasNoPhotons) {
    Scene scene;
    addFloor(scene, lambert(1), 2);
    const PhotonMap dark = trace(scene, 1000);
    EXPECT_TRUE(dark.photons.empty());
    EXPECT_EQ(dark.stats.emittedWatts, glm::dvec3(0));
    const PhotonIndex index(dark.photons);
    EXPECT_EQ(photonIrradiance({dark, index}, glm::vec3(0), {0, 1, 0}, {}, nullptr), glm::vec3(0));
    EXPECT_TRUE(trace(Scene{}, 1000).photons.empty());
    scene.lights = {pointLight(glm::vec3(1), {0, 1, 0})};
    EXPECT_TRUE(trace(scene, 0).photons.empty());
}

TEST(PhotonMap, StopsWhenAsked) {
    struct Stop : SilentProgress {
        bool stopRequested() const override { return true; }
    } stop;
    const Scene scene = leakyRoom();
    EXPECT_THROW(tracePhotons(RayScene(scene), LightSampler(scene), {}, stop), Interrupted);
}

TEST(PhotonMap, ALightOnASurfaceGivesNumbers) {
    Scene scene;
    addFloor(scene, lambert(0.5f), 2);
    scene.lights = {pointLight(glm::vec3(1), glm::vec3(0))};
    for (const Photon& photon : trace(scene, 10'000).photons) {
        ASSERT_TRUE(std::isfinite(glm::dot(photon.position, photon.fluxWatts)));
        ASSERT_TRUE(std::isfinite(glm::dot(photon.towardOrigin, photon.normal)));
    }
}

// Radiance that a path from `origin` finds: the light at every hit, then on by the BRDF, seen by the eye's
// way.
double pathRadiance(const RayScene& rays, const LightSampler& lights, glm::vec3 origin, glm::vec3 direction,
                    Rng& rng) {
    double radiance = 0, throughput = 1;
    for (int bounce = 0; bounce < 40; ++bounce) {
        const SurfacePoint point = surfaceAt(rays.scene(), rays.closestHit(origin, direction), direction);
        const glm::vec3 towardEye = point.shading.toLocal(-direction);
        const LightSample light = lights.samplePunctual(0, point.position);
        const glm::vec3 towardLight = point.shading.toLocal(light.towardLight);
        radiance += throughput * (evaluateBrdf(point.brdf, towardEye, towardLight) * light.radiance).x;
        const float lobe = rng.uniform();
        const BrdfSample next = sampleBrdf(point.brdf, towardEye, lobe, rng.uniform2());
        throughput *= next.weight.x;
        if (!(throughput > 0)) break;
        origin = rays.offsetOrigin(point.position, point.normalGeometric);
        direction = point.shading.toWorld(next.direction);
    }
    return radiance;
}

struct Mean {
    double value = 0;
    double standardError = 0;
};

template <typename Draw>
Mean meanOf(int count, Draw draw) {
    double sum = 0, squares = 0;
    for (int i = 0; i < count; ++i) {
        const double x = draw(i);
        sum += x;
        squares += x * x;
    }
    const double mean = sum / count;
    return {mean, std::sqrt((squares / count - mean * mean) / (count - 1))};
}

// Photons and paths meet the same light under a BRDF that is not symmetric: a coat over plastic. Tells a
// swapped eye and light, or a wrong cosine, from the adjoint.
TEST(PhotonMap, PhotonsAndPathsAgree) {
    Scene scene;
    Material wall;
    wall.baseColor = {0.7f, 0.7f, 0.7f, 1};
    wall.metallic = 0;
    wall.roughness = 0.5f;
    wall.clearcoat = 1;
    wall.clearcoatRoughness = 0.4f;
    addRoom(scene, wall, {1, 2, 1});
    scene.lights = {pointLight(glm::vec3(1), {0.3f, 1.5f, 0.6f})};
    constexpr uint32_t kFloorSurface = 2;  // 1 m2
    const Mean photons = meanOf(20, [&](int seed) {
        double sum = 0;
        for (const Photon& photon : trace(scene, 10'000, 40, uint64_t(seed)).photons) {
            const bool onFloor = scene.triangleSurface[photon.triangle] == kFloorSurface;
            if (onFloor && !photon.firstHit) sum += photon.fluxWatts.x;
        }
        return sum;
    });
    const RayScene rays(scene);
    const LightSampler lights(scene);
    Rng rng(5);
    const Mean paths = meanOf(60'000, [&](int) {
        const glm::vec2 place = rng.uniform2();
        const glm::vec3 local = squareToCosineHemisphere(rng.uniform2());
        return double(kPi) *
               pathRadiance(rays, lights, {place.x, 1e-6f, place.y}, {local.x, local.z, local.y}, rng);
    });
    EXPECT_NEAR(photons.value, paths.value, 4 * std::hypot(photons.standardError, paths.standardError));
    EXPECT_LT(photons.standardError, 0.01 * paths.value);
    EXPECT_LT(paths.standardError, 0.01 * paths.value);
}

// Irradiance E cos(45) on the floor: the photons that land on it carry E cos A. All of them are due to land
// on the disc of the sphere at equal density, so the count on 4 m2 * cos of the 2 pi m2 disc is binomial-like
// or better.
TEST(PhotonMap, DirectionalLightOnAPlane) {
    Scene scene;
    addFloor(scene, lambert(0), 2);
    scene.lights = {directionalLight(glm::vec3(7), glm::normalize(glm::vec3(1, -1, 0)))};
    const PhotonMap map = trace(scene, 100'000);
    double sum = 0;
    for (const Photon& photon : map.photons) sum += photon.fluxWatts.x;
    const double share = 4 * std::sqrt(0.5) / (2 * double(kPi));
    const double relativeError = std::sqrt((1 - share) / (share * 100'000));
    EXPECT_NEAR(sum / 4, 7 * std::sqrt(0.5), 7 * std::sqrt(0.5) * 4 * relativeError);
    EXPECT_NEAR(map.stats.emittedWatts.x, 7 * 2 * double(kPi), 1e-4);
}

// I cos / d^2 below and beside a point light. The estimate from k - 1 of k photons has a standard deviation
// of 1 / sqrt(k - 2) of random photons, less of these; the curvature of E over the disc stays below 1 %.
TEST(PhotonDensity, IrradianceUnderAPointLight) {
    Scene scene;
    addFloor(scene, lambert(0), 4);
    scene.lights = {pointLight(glm::vec3(100, 50, 25), {0, 1, 0})};
    const PhotonMap map = trace(scene, 400'000);
    const PhotonIndex index(map.photons);
    const DensityEstimate settings{502, 0.25f};
    for (float x : {0.0f, 0.5f, 1.0f}) {
        const glm::vec3 found = photonIrradiance({map, index}, {x, 0, 0}, {0, 1, 0}, settings, nullptr);
        const float expected = 100 * std::pow(1 + x * x, -1.5f);
        EXPECT_NEAR(found.x, expected, expected * 4 / std::sqrt(500.0f)) << x;
        EXPECT_NEAR(found.y, found.x / 2, 1e-4f * found.x);
        EXPECT_NEAR(found.z, found.x / 4, 1e-4f * found.x);
    }
}

// Closed white furnace: L = 1 + .5 L = 2 nit everywhere, E = 2 pi. Photons of one flux each, since the albedo
// is the same everywhere; a wall's count is Poisson's, widened by the photons' several hits.
TEST(PhotonDensity, FurnaceBox) {
    const glm::vec3 size(2, 1, 1.5f);
    Scene scene;
    addRoom(scene, emitter(glm::vec3(1), 0.5f), size);
    const PhotonMap map = trace(scene, 200'000, 40);
    EXPECT_EQ(map.stats.escapedWatts, glm::dvec3(0));

    double wallFlux[6] = {};
    uint64_t wallCount[6] = {};
    for (const Photon& photon : map.photons) {
        wallFlux[scene.triangleSurface[photon.triangle]] += photon.fluxWatts.x;
        ++wallCount[scene.triangleSurface[photon.triangle]];
    }
    const double areas[] = {1.5, 3, 2};
    for (int wall = 0; wall < 6; ++wall) {
        const double expected = 2 * double(kPi) * areas[wall / 2];
        EXPECT_NEAR(wallFlux[wall], expected, expected * 4 * 2 / std::sqrt(double(wallCount[wall]))) << wall;
    }

    // 400 points inside of the walls; the estimates overlap, so the mean is as good as the photons under
    // them.
    const PhotonIndex index(map.photons);
    const DensityEstimate settings{50, 0.1f};
    double sum = 0, firstSum = 0;
    Rng rng(2);
    constexpr int kPoints = 400;
    for (int i = 0; i < kPoints; ++i) {
        const int axis = i % 3;
        glm::vec3 position = 0.15f + (size - 0.3f) * glm::vec3(rng.uniform(), rng.uniform(), rng.uniform());
        glm::vec3 normal(0);
        position[axis] = i % 2 ? size[axis] : 0;
        normal[axis] = i % 2 ? -1.0f : 1.0f;
        sum += photonIrradiance({map, index}, position, normal, settings, nullptr).x;
        firstSum += photonIrradiance({map, index}, position, normal, settings, [](const Photon& photon) {
                        return photon.firstHit;
                    }).x;
    }
    const double error = 4 / std::sqrt(48.0 * kPoints);
    EXPECT_NEAR(sum / kPoints, 2 * double(kPi), 2 * double(kPi) * error);
    EXPECT_NEAR(firstSum / kPoints, double(kPi), double(kPi) * error);

    // The other side of a wall is not lit by it.
    EXPECT_EQ(photonIrradiance({map, index}, {1, 0, 0.75f}, {0, -1, 0}, settings, nullptr), glm::vec3(0));

    // Reflected: .5 of E / pi, any way.
    const RayScene rays(scene);
    const glm::vec3 down = glm::normalize(glm::vec3(0.3f, -1, 0.2f));
    const SurfacePoint point = surfaceAt(scene, rays.closestHit({1, 0.5f, 0.75f}, down), down);
    const float radiance = photonRadiance({map, index}, point, -down, {1002, 0.25f}, nullptr).x;
    EXPECT_NEAR(radiance, 1.0f, 4 / std::sqrt(1000.0f));
}

// Fewer photons than asked for: all of them over the disc of the largest radius.
TEST(PhotonDensity, ThinPhotonsUseTheWholeDisc) {
    PhotonMap map;
    Photon photon;
    photon.fluxWatts = glm::vec3(2);
    photon.normal = {0, 1, 0};
    photon.towardOrigin = {0, 1, 0};
    map.photons = {photon, photon, photon};
    map.photons[2].normal = {1, 0, 0};
    const PhotonIndex index(map.photons);
    const float area = kPi * 0.25f;
    const auto at = [&](uint32_t k) {
        return photonIrradiance({map, index}, {0.1f, 0, 0}, {0, 1, 0}, {k, 0.5f}, nullptr).x;
    };
    EXPECT_FLOAT_EQ(at(3), 4 / area);
    EXPECT_FLOAT_EQ(at(2), 2 / (kPi * 0.01f));  // the second marks the rim
    // All in one place: a bound instead of a division by zero.
    EXPECT_TRUE(std::isfinite(photonIrradiance({map, index}, glm::vec3(0), {0, 1, 0}, {2, 0.5f}, nullptr).x));
}

TEST(PhotonMap, SidesAbsorbAndShine) {
    // A one-sided floor lit from below is black and stores nothing; a double-sided one reflects on both
    // sides.
    Scene scene;
    addFloor(scene, lambert(0.5f), 2);
    scene.lights = {pointLight(glm::vec3(1), {0, -1, 0})};
    EXPECT_TRUE(trace(scene, 10'000).photons.empty());
    scene.materials[0].doubleSided = true;
    const PhotonMap below = trace(scene, 10'000);
    EXPECT_GT(below.photons.size(), 1000u);
    for (const Photon& photon : below.photons) {
        ASSERT_TRUE(photon.backFace && photon.punctual && photon.firstHit);
        ASSERT_EQ(photon.normal.y, -1.0f);
    }

    // A double-sided lamp between floor and ceiling lights both alike: half of the photons go each way.
    Scene sandwich;
    addFloor(sandwich, lambert(0), 200, -1);
    addCeiling(sandwich, lambert(0), 200, 1);
    Material lamp = emitter(glm::vec3(1));
    lamp.doubleSided = true;
    addFloor(sandwich, lamp, 1);
    double flux[2] = {};
    for (const Photon& photon : trace(sandwich, 100'000).photons) {
        ASSERT_FALSE(photon.punctual);
        flux[photon.position.y > 0] += photon.fluxWatts.x;
    }
    // The walls' ends see the lamp under tan = 100: 1e-4 of its light escapes.
    EXPECT_NEAR(flux[0], double(kPi), 2e-3);
    EXPECT_NEAR(flux[1], double(kPi), 2e-3);
}

// Light that its range cuts on the way counts as absorbed and is not in the stored flux.
TEST(PhotonMap, RangeDimsTheFirstHit) {
    Scene scene;
    addRoom(scene, lambert(0), glm::vec3(2));
    scene.lights = {pointLight(glm::vec3(10), glm::vec3(1))};
    scene.lights[0].rangeMeters = 1.5f;
    const PhotonMap map = trace(scene, 10'000);
    const float full = 40 * kPi / 10'000;
    for (const Photon& photon : map.photons) {
        const float share = 1 - std::pow(glm::distance(photon.position, glm::vec3(1)) / 1.5f, 4.0f);
        ASSERT_NEAR(photon.fluxWatts.x, full * share, 1e-4f * full);
    }
    EXPECT_NEAR(map.stats.absorbedWatts.x, 40 * double(kPi), 1e-3);
}

}  // namespace
}  // namespace phat
