// Directions learnt from photons: their density, and pictures of paths that follow them.

#include "core/transport/path_guide.h"

#include <gtest/gtest.h>

#include "core/base/hemisphere_map.h"
#include "core/render/path_tracer.h"
#include "support/chi_squared.h"
#include "support/scene_builder.h"

namespace phat {
namespace {

using namespace test;

// Reflected photons on a floor around the origin, most of them from one direction.
std::vector<Photon> photonsOnAFloor(size_t count, glm::vec3 mostlyFrom) {
    std::vector<Photon> photons(count);
    Rng rng(1);
    for (size_t i = 0; i < count; ++i) {
        Photon& photon = photons[i];
        photon.position = {rng.uniform() - 0.5f, 0, rng.uniform() - 0.5f};
        photon.normal = {0, 1, 0};
        photon.fluxWatts = glm::vec3(1);
        const glm::vec3 any = squareToHemisphere(rng.uniform2());
        photon.towardOrigin = i % 4 ? mostlyFrom : glm::vec3(any.x, any.z, any.y);
    }
    return photons;
}

TEST(PathGuide, DirectionsFollowTheirDensity) {
    const glm::vec3 from = glm::normalize(glm::vec3(0.5f, 0.6f, -0.3f));
    const PathGuide guide(photonsOnAFloor(800, from));
    const PathGuide::Density* density = guide.at({0.1f, 0, 0.1f}, {0, 1, 0});
    ASSERT_TRUE(density);

    // Finer bins than the histogram's, so that places within a cell are tested, too.
    constexpr int kBins = 3 * PathGuide::kSize, kSamples = 400'000;
    std::vector<double> counts(kBins * kBins), expected(kBins * kBins);
    for (int y = 0; y < kBins; ++y)
        for (int x = 0; x < kBins; ++x) {
            const glm::vec2 middle((float(x) + 0.5f) / kBins, (float(y) + 0.5f) / kBins);
            const glm::vec3 direction = density->frame.toWorld(squareToHemisphere(middle));
            expected[size_t(y * kBins + x)] =
                kSamples * double(sampleGuidePdf(*density, direction)) * 2 * double(kPi) / (kBins * kBins);
        }
    Rng rng(2);
    for (int i = 0; i < kSamples; ++i) {
        const glm::vec3 direction = sampleGuide(*density, rng.uniform2());
        const glm::ivec2 bin = glm::min(
            glm::ivec2(hemisphereToSquare(density->frame.toLocal(direction)) * float(kBins)), kBins - 1);
        ++counts[size_t(bin.y * kBins + bin.x)];
    }
    double all = 0;
    for (const double bin : expected) all += bin;
    EXPECT_NEAR(all / kSamples, 1, 1e-4);
    const ChiSquared test = chiSquared(counts, expected);
    EXPECT_LT(test.value, test.limit);

    EXPECT_GT(sampleGuidePdf(*density, from), 10 / (2 * kPi));
    EXPECT_GT(sampleGuidePdf(*density, glm::normalize(glm::vec3(-0.5f, 0.6f, 0.3f))), 0.05f / (2 * kPi));
    EXPECT_EQ(sampleGuidePdf(*density, {0, -1, 0}), 0);
}

TEST(PathGuide, KnowsItsPlaces) {
    std::vector<Photon> photons = photonsOnAFloor(20'000, {0, 1, 0});
    for (Photon& photon : photons)
        if (photon.position.x > 0) photon.towardOrigin = glm::normalize(glm::vec3(1, 1, 0));
    const PathGuide guide(photons);
    const glm::vec3 up(0, 1, 0), aside = glm::normalize(glm::vec3(1, 1, 0));
    const auto pdf = [&](float x, glm::vec3 direction) {
        return sampleGuidePdf(*guide.at({x, 0, 0.2f}, {0, 1, 0}), direction);
    };
    EXPECT_GT(pdf(-0.3f, up), 20 * pdf(-0.3f, aside));
    EXPECT_GT(pdf(0.3f, aside), 20 * pdf(0.3f, up));
    EXPECT_FALSE(guide.at({0, 0, 0}, {0, -1, 0})) << "no photon has arrived at a ceiling";
    EXPECT_FALSE(PathGuide().at({0, 0, 0}, {0, 1, 0}));

    for (Photon& photon : photons) photon.firstHit = true;
    EXPECT_TRUE(PathGuide(photons).empty()) << "direct light is sampled otherwise";
}

// A room whose lamp shines up at the ceiling: all its light comes from one spot there.
struct LitFromTheCeiling {
    LitFromTheCeiling() {
        Material wall = lambert(0.5f);
        wall.specular = 1;
        wall.roughness = 0.5f;
        addRoom(scene, wall, {3, 2, 3});
        addFloor(scene, emitter({50, 50, 50}), 0.3f, 1.8f);
        for (glm::vec3& p : std::span(scene.positions).last(6)) p += glm::vec3(0.6f, 0, 0.6f);
        // Its case: no light goes down.
        addCeiling(scene, lambert(0.2f), 0.3f, 1.799f);
        for (glm::vec3& p : std::span(scene.positions).last(6)) p += glm::vec3(0.6f, 0, 0.6f);
        camera.worldFromCamera = glm::mat4(1, 0, 0, 0, 0, 0, -1, 0, 0, 1, 0, 0, 1.5f, 1, 2, 1);  // looks down
        camera.yfovRadians = glm::radians(50.0f);
    }
    Scene scene;
    Camera camera;
};

// Guided paths have the same mean in far less noise.
TEST(PathGuide, PathsAreUnbiasedAndQuieter) {
    const LitFromTheCeiling world;
    const RayScene rays(world.scene);
    const LightSampler lights(world.scene);
    SilentProgress silent;
    const PathGuide guide = learnGuide(rays, lights, 1e6, 1, silent);
    ASSERT_FALSE(guide.empty());
    for (const Component component :
         {Component::all, Component::diffuseIndirect, Component::glossyIndirect}) {
        double mean[2] = {}, variance[2] = {};
        for (const bool guided : {false, true}) {
            PictureSettings settings;
            settings.width = settings.height = 16;
            settings.camera = world.camera;
            settings.samplesPerPixel = 512;
            const Integrator integrator =
                pathTracer(rays, lights, component, world.scene, guided ? &guide : nullptr);
            const TracedPicture picture = tracePicture(settings, integrator, silent);
            for (size_t i = 0; i < picture.mean.pixels.size(); ++i) {
                mean[guided] += double(picture.mean.pixels[i].x);
                variance[guided] += double(picture.variance.pixels[i].x);
            }
        }
        EXPECT_NEAR(mean[1], mean[0], 4 * std::sqrt(variance[0] + variance[1])) << int(component);
        EXPECT_LT(std::sqrt(variance[0] + variance[1]), 0.03 * mean[0]) << "the test tells nothing";
        // The glossy part is sampled by the lobe itself at the first reflection.
        EXPECT_LT(variance[1], (component == Component::glossyIndirect ? 0.9 : 0.6) * variance[0])
            << int(component);
    }
}

// Albedo .5 and emission 1 all round: 2 in every direction, whichever way the photons point.
TEST(PathGuide, AFurnaceStaysAFurnace) {
    Scene scene;
    addRoom(scene, emitter({1, 1, 1}, 0.5f), {1, 1, 1});
    const RayScene rays(scene);
    const LightSampler lights(scene);
    std::vector<Photon> photons = photonsOnAFloor(5000, glm::normalize(glm::vec3(0.5f, 0.6f, -0.3f)));
    for (Photon& photon : photons) photon.position += glm::vec3(0.5f, 0, 0.5f);
    const PathGuide guide(photons);
    PictureSettings settings;
    settings.width = settings.height = 16;
    settings.camera.worldFromCamera = glm::mat4(1, 0, 0, 0, 0, 0, -1, 0, 0, 1, 0, 0, 0.5f, 0.9f, 0.5f, 1);
    settings.camera.yfovRadians = glm::radians(40.0f);
    settings.samplesPerPixel = 256;
    SilentProgress silent;
    const TracedPicture picture =
        tracePicture(settings, pathTracer(rays, lights, Component::all, scene, &guide), silent);
    double mean = 0, variance = 0;
    for (size_t i = 0; i < picture.mean.pixels.size(); ++i) {
        mean += double(picture.mean.pixels[i].x) / 256;
        variance += double(picture.variance.pixels[i].x) / (256 * 256);
    }
    EXPECT_NEAR(mean, 2, 4 * std::sqrt(variance));
    EXPECT_LT(std::sqrt(variance), 0.003 * 2) << "the test tells nothing";
}

TEST(PathGuide, IsLearntWhereItIsWorthItsTime) {
    const LitFromTheCeiling world;
    const RayScene rays(world.scene);
    const LightSampler lights(world.scene);
    SilentProgress silent;
    EXPECT_TRUE(learnGuide(rays, lights, 1e5, 1, silent).empty());
    Scene dark;
    addRoom(dark, lambert(0.5f), {3, 2, 3});
    const RayScene darkRays(dark);
    EXPECT_TRUE(learnGuide(darkRays, LightSampler(dark), 1e9, 1, silent).empty());
}

}  // namespace
}  // namespace phat
