// Light through panes and volumes of glass, against closed forms.

#include "core/scene/glass.h"

#include <gtest/gtest.h>

#include "core/base/hemisphere_map.h"
#include "core/render/path_tracer.h"
#include "core/scene/brdf.h"
#include "core/transport/path.h"
#include "core/transport/photon_map.h"
#include "support/glass_scenes.h"

namespace phat {
namespace {

using namespace test;

// Downward at an angle from the vertical.
glm::vec3 downward(float degrees) {
    const float angle = glm::radians(degrees);
    return {std::sin(angle), -std::cos(angle), 0};
}

// The reflectance of one interface from outside.
float reflectanceOf(const Material& material, float cosine) {
    const float f0 = square((material.ior - 1) / (material.ior + 1));
    return specularAlbedo(glm::vec3(f0), 1, std::max(square(material.roughness), kMinAlpha), cosine).x;
}

constexpr float kThick = 0.01f;
Scene slabScene(const Material& material) {
    Scene scene;
    addBox(scene, material, {-50, -kThick, -50}, {50, 0, 50});
    return scene;
}

TEST(Glass, IsAVolumeWhereItsTrianglesCloseOne) {
    Scene scene;
    addBox(scene, solidGlass(), {0, 0, 0}, {1, 1, 1});
    addBox(scene, solidGlass(), {2, 0, 0}, {3, 1, 1}, 3);
    addFloor(scene, solidGlass(), 1);
    addBox(scene, glass(), {4, 0, 0}, {5, 1, 1});
    addSphere(scene, solidGlass(), {8, 0, 0}, 1, 6);
    addFloor(scene, lambert(0.5f), 1);
    Material glowing = solidGlass();
    glowing.emission = glm::vec3(1);
    addBox(scene, glowing, {10, 0, 0}, {11, 1, 1});
    const std::vector<Glass> found = glassOfSurfaces(scene, scene.materials);
    EXPECT_EQ(found, (std::vector<Glass>{Glass::volume, Glass::thin, Glass::thin, Glass::thin, Glass::volume,
                                         Glass::none, Glass::none}));
    // Two surfaces of one node close a volume together.
    Scene halves;
    addBox(halves, solidGlass(), {0, 0, 0}, {1, 1, 1}, 3);
    addSurface(halves, solidGlass());
    halves.surfaces[1].node = halves.surfaces[0].node;
    const glm::vec2 uv[] = {{0, 0}, {1, 0}, {1, 1}};
    const glm::vec3 one[] = {{0, 1, 0}, {0, 1, 1}, {1, 1, 1}}, two[] = {{0, 1, 0}, {1, 1, 1}, {1, 1, 0}};
    addTriangle(halves, one, uv);
    addTriangle(halves, two, uv);
    EXPECT_EQ(glassOfSurfaces(halves, halves.materials), (std::vector<Glass>{Glass::volume, Glass::volume}));
    EXPECT_TRUE(glassOfSurfaces(Scene{}, {}).empty());
}

// A thin pane: one interface, as glTF says. What it does not reflect it lets through, tinted.
TEST(Glass, ThinPanesSplitLightByFresnel) {
    for (const float degrees : {0.0f, 50.0f, 75.0f}) {
        Material material = glass();
        material.baseColor = {0.8f, 0.5f, 0.2f, 1};
        material.transmission = 0.9f;
        Scene scene;
        addFloor(scene, material, 100);
        const RayScene rays(scene);
        const Ray ray{{0, 1, 0}, downward(degrees)};
        const float reflected = reflectanceOf(material, -ray.direction.y);
        const glm::vec3 want = 0.9f * (1 - reflected) * glm::vec3(material.baseColor);
        uint64_t count = 0;
        const StraightView view = seeStraight(rays, ray, 1e30f, count);
        EXPECT_FALSE(view.hit);
        constexpr int kRays = 20'000;
        glm::vec3 through(0), stayed(0);
        for (int i = 0; i < kRays; ++i) {
            const SeenThrough seen = seeThrough(rays, ray, uint64_t(i), count);
            (seen.hit ? stayed : through) += seen.throughput / float(kRays);
            if (!seen.hit) {
                EXPECT_EQ(seen.ray.direction, ray.direction);
            }
        }
        // Three standard errors of a binomial share: 3 sqrt(p (1 - p) / n) < .011.
        for (int c = 0; c < 3; ++c) {
            EXPECT_NEAR(view.transmittance[c], want[c], 1e-5f) << degrees;
            EXPECT_NEAR(through[c], want[c], 0.011f) << degrees;
            EXPECT_NEAR(stayed[c], 1, 0.03f) << degrees;
        }
    }
}

// R + (1-R)^2 R / (1-R^2) = 2R / (1+R) and (1-R)^2 / (1-R^2) = (1-R) / (1+R) [Stokes 1862].
TEST(Glass, SlabsReflectAndTransmitAsStokesSays) {
    for (const float degrees : {0.0f, 50.0f, 75.0f}) {
        const Material material = solidGlass();
        const Scene scene = slabScene(material);
        const RayScene rays(scene);
        const Ray ray{{0, 1, 0}, downward(degrees)};
        const float r = reflectanceOf(material, -ray.direction.y);
        uint64_t count = 0;
        EXPECT_NEAR(seeStraight(rays, ray, 1e30f, count).transmittance.x, (1 - r) / (1 + r), 1e-4f);
        constexpr int kRays = 40'000;
        double down = 0, up = 0, first = 0;
        for (int i = 0; i < kRays; ++i) {
            const SeenThrough seen = seeThrough(rays, ray, uint64_t(i), count);
            EXPECT_NEAR(std::abs(seen.ray.direction.y), std::abs(ray.direction.y), 1e-4f);
            // What stays at the first interface is reflected by its BRDF, of albedo R.
            const double light = double(seen.throughput.x) / kRays;
            if (seen.hit)
                first += light * double(r);
            else
                (seen.ray.direction.y < 0 ? down : up) += light;
        }
        // Three standard errors, and the split sum's table, 2e-3.
        EXPECT_NEAR(down, double((1 - r) / (1 + r)), 0.0095) << degrees;
        EXPECT_NEAR(up + first, double(2 * r / (1 + r)), 0.0095) << degrees;
    }
    EXPECT_NEAR(reflectanceOf(solidGlass(), 1), 0.04f, 2e-3f);
}

TEST(Glass, BendsBySnell) {
    const Scene scene = slabScene(solidGlass(1.5f));
    const RayScene rays(scene);
    const Ray ray{{0, 1, 0}, downward(60)};
    for (uint64_t seed = 0;; ++seed) {
        GlassWalk walk(rays, ray, seed);
        if (!walk.passes(rays.closestHit(ray.origin, ray.direction))) continue;
        EXPECT_TRUE(walk.inside());
        EXPECT_NEAR(walk.ray().direction.x, std::sin(glm::radians(60.0f)) / 1.5f, 1e-5f);
        EXPECT_LT(walk.ray().direction.y, 0);
        const Hit bottom = rays.closestHit(walk.ray().origin, walk.ray().direction);
        ASSERT_TRUE(walk.passes(bottom));
        if (walk.inside()) continue;  // reflected back
        EXPECT_NEAR(walk.ray().direction.x, ray.direction.x, 1e-5f);
        // The shift along the slab: tan of the inner angle. The ray begins a little below.
        const float slope = std::tan(glm::radians(60.0f));
        const float inner = std::asin(std::sin(glm::radians(60.0f)) / 1.5f);
        const glm::vec3 origin = walk.ray().origin;
        EXPECT_LT(origin.y, -kThick);
        EXPECT_NEAR(origin.x - slope * (-kThick - origin.y), slope + kThick * std::tan(inner), 1e-5f);
        break;
    }
}

// From inside, beyond the critical angle of 41.8 degrees nothing leaves.
TEST(Glass, ReflectsTotallyFromInside) {
    const Scene scene = slabScene(solidGlass());
    const RayScene rays(scene);
    for (uint64_t seed = 0; seed < 100; ++seed) {
        const Ray ray{{0, -kThick / 2, 0}, downward(45)};
        GlassWalk walk(rays, ray, seed);
        ASSERT_TRUE(walk.passes(rays.closestHit(ray.origin, ray.direction)));
        EXPECT_TRUE(walk.inside());
        EXPECT_NEAR(walk.ray().direction.y, -ray.direction.y, 1e-5f);
        EXPECT_EQ(walk.throughput(), glm::vec3(1));
    }
}

TEST(Glass, AbsorbsByBeersLaw) {
    Material material = solidGlass();
    material.attenuationColor = {0.5f, 0.25f, 1};
    material.attenuationDistance = 0.02f;
    const Scene scene = slabScene(material);
    const RayScene rays(scene);
    const Ray ray{{0, 1, 0}, downward(60)};
    const float inner = std::asin(std::sin(glm::radians(60.0f)) / 1.5f);
    const float r = reflectanceOf(material, -ray.direction.y);
    const glm::vec3 left = glm::pow(material.attenuationColor, glm::vec3(kThick / std::cos(inner) / 0.02f));
    const glm::vec3 want = square(1 - r) * left / (1.0f - r * r * left * left);
    uint64_t count = 0;
    const StraightView view = seeStraight(rays, ray, 1e30f, count);
    glm::vec3 down(0);
    constexpr int kRays = 40'000;
    for (int i = 0; i < kRays; ++i) {
        const SeenThrough seen = seeThrough(rays, ray, uint64_t(i), count);
        if (!seen.hit && seen.ray.direction.y < 0) down += seen.throughput / float(kRays);
    }
    for (int c = 0; c < 3; ++c) {
        // Rays leave a surface from a point 2^-16 m off it, which makes the way by .1 % longer or shorter.
        EXPECT_NEAR(view.transmittance[c], want[c], 6e-4f);
        EXPECT_NEAR(down[c], want[c], 0.0095f);
    }
    // A pane with a thickness is a slab that is drawn as one surface, of one interface.
    Scene pane;
    material.thickness = kThick;
    addFloor(pane, material, 100);
    const glm::vec3 paneWant = (1 - r) * left;
    const StraightView through = seeStraight(RayScene(pane), ray, 1e30f, count);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(through.transmittance[c], paneWant[c], 1e-4f);
    // The node scales what the material says.
    pane.materials.back().thickness = kThick / 4;
    pane.surfaces.back().metersPerUnit = 4;
    const StraightView scaled = seeStraight(RayScene(pane), ray, 1e30f, count);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(scaled.transmittance[c], paneWant[c], 1e-4f);
}

double meanRadiance(const Scene& scene, glm::vec3 eye, float yfovDegrees, int samples) {
    const RayScene rays(scene);
    const LightSampler lights(scene);
    PictureSettings settings;
    settings.width = settings.height = 16;
    settings.camera.worldFromCamera[3] = glm::vec4(eye, 1);
    settings.camera.yfovRadians = glm::radians(yfovDegrees);
    settings.samplesPerPixel = samples;
    SilentProgress silent;
    const Image image = tracePicture(settings, pathTracer(rays, lights, Component::all), silent).mean;
    double sum = 0;
    for (const glm::vec3& pixel : image.pixels) sum += double(pixel.x) / double(image.pixels.size());
    return sum;
}

// White glass neither takes light nor adds any: in a furnace it cannot be seen. The specular lobes lose what
// bounces between microfacets, which is why rough ones are a little darker.
TEST(Glass, CannotBeSeenInAFurnace) {
    for (const float roughness : {0.0f, 0.4f}) {
        Scene pane, slab, ball;
        addQuad(pane, glass(1.5f, roughness), {-3, -3, -1}, {6, 0, 0}, {0, 6, 0});
        addBox(slab, solidGlass(1.5f, roughness), {-3, -3, -1}, {3, 3, -0.9f});
        addSphere(ball, solidGlass(1.5f, roughness), {0, 0, -3}, 1, 32);
        for (Scene* scene : {&pane, &slab, &ball}) {
            scene->environment = uniformSky(glm::vec3(1));
            // 16^2 * 256 samples, each of a spread below .5: standard error .002.
            EXPECT_NEAR(meanRadiance(*scene, {0, 0, 0}, 36, 256), 1, roughness > 0 ? 0.012 : 0.006)
                << roughness << ' ' << scene->triangles.size();
        }
    }
}

// Irradiance of a floor under a pane, by the irradiance estimator, by paths and by photons.
TEST(Glass, LightsTheFloorBehindIt) {
    for (const bool closed : {false, true}) {
        Scene scene;
        Material material = closed ? solidGlass() : glass();
        material.baseColor = {0.9f, 0.6f, 0.9f, 1};
        addFloor(scene, lambert(1), 40);
        if (closed)
            addBox(scene, material, {-20, 1 - kThick, -20}, {20, 1, 20});
        else
            addFloor(scene, material, 40, 1);
        scene.environment = uniformSky(glm::vec3(1));
        scene.lights.push_back(directionalLight(glm::vec3(3), downward(30)));
        // The integral of T cos over the sky above the pane, whose edges lie below 3 degrees.
        double sky = 0;
        constexpr int kSteps = 2000;
        const auto transmittance = [&](float cosine) {
            const float r = reflectanceOf(material, cosine);
            return closed ? (1 - r) / (1 + r) : 1 - r;
        };
        for (int i = 0; i < kSteps; ++i) {
            const float sin2 = (float(i) + 0.5f) / kSteps;
            sky += double(kPi * transmittance(std::sqrt(1 - sin2))) / kSteps;
        }
        const float sunCosine = std::cos(glm::radians(30.0f));
        const double sun = double(3 * sunCosine * transmittance(sunCosine));
        const double tint = closed ? 0.6 * 0.6 : 0.6;

        const RayScene rays(scene);
        const LightSampler lights(scene);
        const LitScene lit{rays, lights};
        uint64_t count = 0;
        const IrradianceEstimate estimate =
            areaIrradiance(lit, {0, 0, 0}, {0, 1, 0}, {4096, 4}, Rng(1), count);
        EXPECT_NEAR(double(estimate.value.y) / (tint * sky), 1, 0.02) << closed;

        const Hit floor = rays.closestHit({0, 0.5f, 0}, {0, -1, 0});
        const SurfacePoint point = surfaceAt(scene, floor, {0, -1, 0});
        glm::dvec3 reflected(0);
        constexpr int kPaths = 40'000;
        Rng rng(2);
        for (int i = 0; i < kPaths; ++i) {
            PathNumbers numbers{Rng(rng.bits64())};
            reflected +=
                glm::dvec3(tracePath(lit, {point, {0, 1, 0}}, 1, numbers, count).direct) / double(kPaths);
        }
        // The floor reflects all of it: times pi it is the irradiance.
        EXPECT_NEAR(reflected.y * double(kPi) / (tint * (sky + sun)), 1, 0.02) << closed;

        SilentProgress silent;
        const PhotonMap map = tracePhotons(rays, lights, {.count = 400'000, .maxBounces = 0}, silent);
        double first = 0;
        for (const Photon& photon : map.photons)
            if (photon.firstHit && photon.position.y == 0 && photon.normal.y > 0 &&
                glm::length(photon.position) < 2)
                first += double(photon.fluxWatts.y) / (double(kPi) * 4);
        EXPECT_NEAR(first / (tint * (sky + sun)), 1, 0.05) << closed;
        const glm::dvec3 lost = map.stats.emittedWatts - map.stats.absorbedWatts - map.stats.escapedWatts;
        EXPECT_LT(std::abs(lost.y), 1e-4 * map.stats.emittedWatts.y);
    }
}

// Nothing that is lit through glass counts as buried, nor is it dark.
TEST(Glass, RoughGlassScattersWhatItTransmits) {
    for (const bool closed : {false, true}) {
        Scene scene;
        const Material material = closed ? solidGlass(1.5f, 0.5f) : glass(1.5f, 0.5f);
        if (closed)
            addBox(scene, material, {-50, -kThick, -50}, {50, 0, 50});
        else
            addFloor(scene, material, 100);
        const RayScene rays(scene);
        uint64_t count = 0;
        double mean = 0, through = 0;
        for (uint64_t i = 0; i < 20'000; ++i) {
            const SeenThrough seen = seeThrough(rays, {{0, 1, 0}, {0, -1, 0}}, i, count);
            if (seen.hit || seen.ray.direction.y > 0) continue;
            through += 1;
            mean += double(-seen.ray.direction.y);
        }
        EXPECT_GT(through, closed ? 16'000 : 18'500);
        EXPECT_LT(mean / through, 0.97) << "scattered";
        EXPECT_GT(mean / through, 0.6) << "forward";
    }
}

}  // namespace
}  // namespace phat
