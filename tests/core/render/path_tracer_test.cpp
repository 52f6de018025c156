// Pictures of the path tracer against closed forms.

#include "core/render/path_tracer.h"

#include <gtest/gtest.h>

#include "support/scene_builder.h"

namespace phat {
namespace {

using namespace test;

Camera lookingFrom(glm::vec3 eye, glm::vec3 target, float yfovDegrees = 40) {
    const Frame frame = frameFromNormal(glm::normalize(eye - target));
    Camera camera;
    camera.worldFromCamera = {glm::vec4(frame.tangent, 0), glm::vec4(frame.bitangent, 0),
                              glm::vec4(frame.normal, 0), glm::vec4(eye, 1)};
    camera.yfovRadians = glm::radians(yfovDegrees);
    camera.znear = 1e-3f;
    return camera;
}

TracedPicture picture(const Scene& scene, const Camera& camera, int samples,
                      Component component = Component::all, int size = 8) {
    const RayScene rays(scene);
    const LightSampler lights(scene);
    PictureSettings settings;
    settings.width = settings.height = size;
    settings.camera = camera;
    settings.samplesPerPixel = samples;
    SilentProgress silent;
    return tracePicture(settings, pathTracer(rays, lights, component), silent);
}

struct Mean {
    double value = 0, standardError = 0;
};

// Of the whole picture; its pixels are independent.
Mean meanOf(const TracedPicture& picture) {
    Mean mean;
    double variance = 0;
    const auto count = double(picture.mean.pixels.size());
    for (size_t i = 0; i < picture.mean.pixels.size(); ++i) {
        mean.value += double(picture.mean.pixels[i].x) / count;
        variance += double(picture.variance.pixels[i].x) / (count * count);
    }
    mean.standardError = std::sqrt(variance);
    return mean;
}

// Four standard errors: a correct estimator fails once in 16,000 seeds. `precision` keeps the test sharp.
void expectMean(const TracedPicture& picture, double expected, double precision) {
    const Mean mean = meanOf(picture);
    EXPECT_NEAR(mean.value, expected, 4 * mean.standardError + 1e-4 * expected);
    EXPECT_LT(mean.standardError, precision * expected) << "the test tells nothing";
}

// A narrow view: the closed forms hold at one point.
const Camera kFloorPoint = lookingFrom({0, 0.5f, 0}, {0, 0, 0}, 0.5f);

TEST(PathTracer, PointLightOverAPlane) {
    Scene scene;
    addFloor(scene, lambert(1), 4);
    scene.lights = {pointLight(glm::vec3(100), {0, 1, 0})};
    expectMean(picture(scene, kFloorPoint, 4), 31.831, 1e-3);
    expectMean(picture(scene, kFloorPoint, 4, Component::direct), 31.831, 1e-3);
    EXPECT_EQ(meanOf(picture(scene, kFloorPoint, 4, Component::indirect)).value, 0);
}

TEST(PathTracer, SquareLampOverAPlaneAndSeen) {
    Scene scene;
    addFloor(scene, lambert(1), 4);
    addCeiling(scene, emitter({5, 5, 5}), 1, 1);
    expectMean(picture(scene, kFloorPoint, 256), 1.1973, 0.005);
    const Camera up = lookingFrom({0, 0.5f, 0}, {0, 1, 0}, 10);
    EXPECT_EQ(meanOf(picture(scene, up, 4)).value, 5);
    EXPECT_EQ(meanOf(picture(scene, up, 4, Component::direct)).value, 5);
    EXPECT_EQ(meanOf(picture(scene, up, 4, Component::indirect)).value, 0);
}

// More lights than get a shadow ray each: one is drawn, the mean is that of all.
TEST(PathTracer, ManyLightsSumUp) {
    Scene scene;
    addFloor(scene, lambert(0.8f), 6);
    double expected = 0;
    for (int i = 0; i < 100; ++i) {
        const float x = 0.03f * float(i), candela = 1.0f + float(i % 7);
        scene.lights.push_back(pointLight(glm::vec3(candela), {x, 1, 0}));
        expected +=
            0.8 / double(kPi) * double(candela) / std::pow(1 + double(x * x), 1.5);  // cos = 1 / distance
    }
    expectMean(picture(scene, kFloorPoint, 16), expected, 0.005);

    // Half of them behind a wall: the choice does not know.
    addQuad(scene, lambert(0), {1.485f, 0, -3}, {0, 2, 0}, {0, 0, 6});
    addQuad(scene, lambert(0), {1.485f, 0, -3}, {0, 0, 6}, {0, 2, 0});
    double visible = 0;
    for (int i = 0; i < 50; ++i) {
        const double x = 0.03 * i;
        visible += 0.8 / double(kPi) * (1.0 + i % 7) / std::pow(1 + x * x, 1.5);
    }
    expectMean(picture(scene, kFloorPoint, 128), visible, 0.005);
}

// Albedo .5 and emission 1 all round: 2 in every direction, 1 seen, .5 reflected once, .5 more often.
TEST(PathTracer, FurnaceAndItsComponents) {
    Scene scene;
    addRoom(scene, emitter({1, 1, 1}, 0.5f), {2, 1.5f, 1});
    const Camera camera = lookingFrom({1, 0.75f, 0.5f}, {0, 0.1f, 0.2f}, 80);
    expectMean(picture(scene, camera, 64), 2, 0.005);
    expectMean(picture(scene, camera, 64, Component::direct), 1.5, 0.005);
    expectMean(picture(scene, camera, 64, Component::indirect), 0.5, 0.01);
    expectMean(picture(scene, camera, 64, Component::diffuseIndirect), 0.5, 0.01);
    EXPECT_EQ(meanOf(picture(scene, camera, 4, Component::glossyIndirect)).value, 0);
}

// Both lobes at once: the parts are the whole, and each lobe's share is its albedo's.
TEST(PathTracer, LobesShareTheIndirectLight) {
    Material plastic = emitter({1, 1, 1}, 0.5f);
    plastic.specular = 1;
    plastic.roughness = 0.4f;
    Scene scene;
    addRoom(scene, plastic, {2, 1.5f, 1});
    const Camera camera = lookingFrom({1, 0.75f, 0.5f}, {1, 0, 0.5f}, 1);
    const Mean all = meanOf(picture(scene, camera, 256)),
               direct = meanOf(picture(scene, camera, 256, Component::direct)),
               diffuse = meanOf(picture(scene, camera, 512, Component::diffuseIndirect)),
               glossy = meanOf(picture(scene, camera, 512, Component::glossyIndirect));
    EXPECT_NEAR(direct.value + diffuse.value + glossy.value, all.value,
                4 * std::hypot(std::hypot(all.standardError, direct.standardError),
                               std::hypot(diffuse.standardError, glossy.standardError)));
    // Seen head-on the surface reflects like .5 * (1 - mean Fresnel) diffuse and .04 glossy; the light that
    // both reflect comes from walls that are nearly alike.
    EXPECT_NEAR(glossy.value / diffuse.value, 0.04 / (0.5 * 0.9565), 0.01);
}

// A room of radiance 2 in which the eye sees the walls as another material: 1 of their own, the rest
// reflected.
TEST(PathTracer, WhatTheEyeSeesMayDifferFromWhatLightMeets) {
    Scene scene;
    addRoom(scene, emitter({1, 1, 1}, 0.5f), {2, 1.5f, 1});
    Scene viewedScene = scene;
    for (Material& material : viewedScene.materials) material.baseColor = glm::vec4(0.25f, 0.25f, 0.25f, 1);
    const RayScene rays(scene);
    const LightSampler lights(scene);
    PictureSettings settings;
    settings.width = settings.height = 8;
    settings.camera = lookingFrom({1, 0.75f, 0.5f}, {0, 0.1f, 0.2f}, 80);
    settings.samplesPerPixel = 64;
    SilentProgress silent;
    expectMean(tracePicture(settings, pathTracer(rays, lights, Component::all, viewedScene), silent), 1.5,
               0.005);
    expectMean(tracePicture(settings, pathTracer(rays, lights, Component::indirect, viewedScene), silent),
               0.25, 0.01);
}

// Some pixels alone are what they are in the whole picture.
TEST(PathTracer, TracesTheChosenPixelsOnly) {
    Scene scene;
    addRoom(scene, emitter({1, 1, 1}, 0.5f), {2, 1.5f, 1});
    const RayScene rays(scene);
    const LightSampler lights(scene);
    const Integrator integrator = pathTracer(rays, lights, Component::all);
    PictureSettings settings;
    settings.width = settings.height = 8;
    settings.camera = lookingFrom({1, 0.75f, 0.5f}, {0, 0.1f, 0.2f}, 80);
    settings.samplesPerPixel = 20;
    SilentProgress silent;
    const TracedPicture whole = tracePicture(settings, integrator, silent);
    settings.pixels = {3, 17, 18, 63};
    const TracedPicture some = tracePicture(settings, integrator, silent);
    for (uint32_t i = 0; i < 64; ++i) {
        const bool chosen = std::count(settings.pixels.begin(), settings.pixels.end(), i) > 0;
        EXPECT_EQ(some.mean.pixels[i], chosen ? whole.mean.pixels[i] : glm::vec3(0));
        EXPECT_EQ(some.variance.pixels[i], chosen ? whole.variance.pixels[i] : glm::vec3(0));
    }
    EXPECT_LT(some.rays, whole.rays / 8);
}

// The edge of a lamp runs through one column of pixels.
TEST(PathTracer, PixelsAreTheirSquareOrTheirMiddle) {
    Scene scene;
    addCeiling(scene, emitter({5, 5, 5}), 1, 1);  // up to x = .5
    const RayScene rays(scene);
    const LightSampler lights(scene);
    const Integrator integrator = pathTracer(rays, lights, Component::all);
    PictureSettings settings;
    settings.width = settings.height = 3;
    settings.samplesPerPixel = 4096;
    SilentProgress silent;
    for (const float shift : {-0.01f, 0.01f}) {
        settings.camera.worldFromCamera =
            glm::mat4(1, 0, 0, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0.5f + shift, 0.5f, 0, 1);  // looks up
        settings.camera.yfovRadians = glm::radians(10.0f);
        settings.filter = PixelFilter::box;
        const float square = tracePicture(settings, integrator, silent).mean.at(1, 1).x;
        settings.filter = PixelFilter::center;
        const float middle = tracePicture(settings, integrator, silent).mean.at(1, 1).x;
        // A pixel is .0292 m wide: the edge is .34 of it from its middle. Sixteen batches of 256 stratified
        // samples: one stratum of a batch is in doubt, a standard error of 5 * .5 / 256 / 4 = .0024.
        EXPECT_NEAR(square, shift < 0 ? 5 * 0.8429f : 5 * 0.1571f, 0.012f);
        EXPECT_EQ(middle, shift < 0 ? 5 : 0);
    }
}

TEST(PathTracer, BackgroundIsTheSky) {
    Scene scene;
    addFloor(scene, lambert(0.7f), 0.1f);
    scene.environment = Environment{Image(16, 8, glm::vec3(1.5f))};
    const Camera up = lookingFrom({0, 0.5f, 0}, {0, 1, 0});
    EXPECT_NEAR(meanOf(picture(scene, up, 1)).value, 1.5, 1e-6);
    EXPECT_NEAR(meanOf(picture(scene, up, 1, Component::direct)).value, 1.5, 1e-6);
    EXPECT_EQ(meanOf(picture(scene, up, 1, Component::indirect)).value, 0);
    expectMean(picture(scene, kFloorPoint, 256), 0.7 * 1.5, 0.005);
}

// The eye sees through the backs of single-sided surfaces, as the rasteriser culls them; light does not.
TEST(PathTracer, CameraSeesThroughCulledBacks) {
    Scene scene;
    addFloor(scene, lambert(1), 4);
    scene.lights = {pointLight(glm::vec3(100), {0, 1, 0})};
    for (const float height : {0.2f, 0.3f}) addCeiling(scene, lambert(1), 0.05f, height);  // seen from behind
    const Camera camera = lookingFrom({0, 0.5f, 0}, {0, 0, 0}, 0.5f);
    EXPECT_EQ(meanOf(picture(scene, camera, 4, Component::direct)).value, 0) << "the floor, in shadow";
    const RayScene rays(scene);
    uint64_t count = 0;
    const Hit hit = visibleHit(rays, {{0, 0.5f, 0.01f}, {0, -1, 0}}, count);
    ASSERT_TRUE(hit);
    EXPECT_NEAR(hit.distance, 0.5f, 1e-5f);
    EXPECT_EQ(count, 3u);

    for (Material& material : scene.materials) material.doubleSided = true;
    const RayScene doubleSided(scene);
    EXPECT_NEAR(visibleHit(doubleSided, {{0, 0.5f, 0.01f}, {0, -1, 0}}, count).distance, 0.2f, 1e-5f);
    EXPECT_GT(meanOf(picture(scene, camera, 4)).value, 0);
}

TEST(PathTracer, RaysBeginOnTheNearPlane) {
    Camera camera = lookingFrom({1, 2, 3}, {1, 2, 0}, 90);
    camera.znear = 0.5f;
    for (const bool perspective : {true, false}) {
        camera.perspective = perspective;
        for (const glm::vec2 place : {glm::vec2(0, 0), glm::vec2(8, 4), glm::vec2(3, 7)}) {
            const Ray ray = cameraRay(camera, 16, 8, place);
            EXPECT_NEAR(ray.origin.z, 2.5f, 1e-5f);
            EXPECT_NEAR(glm::length(ray.direction), 1, 1e-6f);
        }
    }
}

// The reported variance is that of the mean, seed to seed: of independent samples, of stratified ones in
// equal batches, and where the last batch is a part of one.
TEST(PathTracer, VarianceIsOfTheMean) {
    Scene scene;
    addFloor(scene, lambert(1), 4);
    addCeiling(scene, emitter({5, 5, 5}), 2, 1);
    const RayScene rays(scene);
    const LightSampler lights(scene);
    PictureSettings settings;
    settings.width = settings.height = 4;
    settings.camera = kFloorPoint;
    SilentProgress silent;
    for (const int samples : {20, 64, 137}) {
        settings.samplesPerPixel = samples;
        double sum = 0, squares = 0, reported = 0;
        constexpr int kSeeds = 400;
        for (int seed = 0; seed < kSeeds; ++seed) {
            settings.seed = uint64_t(seed);
            const TracedPicture traced =
                tracePicture(settings, pathTracer(rays, lights, Component::all), silent);
            for (size_t i = 0; i < traced.mean.pixels.size(); ++i) {
                sum += double(traced.mean.pixels[i].x);
                squares += double(traced.mean.pixels[i].x) * double(traced.mean.pixels[i].x);
                reported += double(traced.variance.pixels[i].x);
            }
        }
        constexpr double kCount = kSeeds * 16;
        const double actual = squares / kCount - (sum / kCount) * (sum / kCount);
        // A variance of 6400 draws is known to about 2 %.
        EXPECT_NEAR(reported / kCount / actual, 1, 0.08) << samples;
    }
}

// Sixteen times the samples have far less than a sixteenth of the variance, since they are stratified.
TEST(PathTracer, StratificationPays) {
    Scene scene;
    addFloor(scene, lambert(1), 4);
    addCeiling(scene, emitter({5, 5, 5}), 2, 1);
    const double few = meanOf(picture(scene, kFloorPoint, 16)).standardError,
                 many = meanOf(picture(scene, kFloorPoint, 256)).standardError;
    EXPECT_LT(many * many, 0.3 * few * few / 16);
}

TEST(PathTracer, OneSampleHasNoVarianceAndTimeStopsIt) {
    Scene scene;
    addFloor(scene, lambert(1), 4);
    EXPECT_EQ(picture(scene, kFloorPoint, 1).variance.pixels[0], glm::vec3(0));
    const RayScene rays(scene);
    const LightSampler lights(scene);
    PictureSettings settings;
    settings.width = settings.height = 4;
    settings.camera = kFloorPoint;
    settings.seconds = 0.05;
    SilentProgress silent;
    // The number of samples counts only without a time: neither a small nor a large one is met. The large one
    // would take some hundred times as long as the time.
    for (const int unheeded : {1, 1 << 22}) {
        settings.samplesPerPixel = unheeded;
        const TracedPicture traced = tracePicture(settings, pathTracer(rays, lights, Component::all), silent);
        EXPECT_GT(traced.samplesPerPixel, 1);
        EXPECT_LT(traced.samplesPerPixel, 1 << 22);
        EXPECT_GE(traced.rays, uint64_t(traced.samplesPerPixel) * 16);
    }
}

}  // namespace
}  // namespace phat
