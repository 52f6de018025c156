#include "core/render/auto_exposure.h"

#include <gtest/gtest.h>

#include "core/base/random.h"
#include "core/scene/default_camera.h"
#include "support/scene_builder.h"

namespace phat {
namespace {

using namespace test;

std::vector<uint32_t> allOf(const Image& picture) {
    std::vector<uint32_t> all(picture.pixels.size());
    for (size_t i = 0; i < all.size(); ++i) all[i] = uint32_t(i);
    return all;
}

float stopsOf(const Image& picture) {
    return autoExposureStops(picture, allOf(picture));
}

Image variedPicture(float scale) {
    Image picture(64, 32);
    Rng rng(7);
    for (glm::vec3& pixel : picture.pixels) pixel = glm::vec3(scale * std::exp2(4 * rng.uniform() - 2));
    return picture;
}

TEST(AutoExposure, BringsOneGreyToMiddleGrey) {
    for (const float grey : {1e-4f, 0.22f, 3.0f, 7e3f}) {
        const float stops = stopsOf(Image(8, 8, glm::vec3(grey)));
        EXPECT_NEAR(grey * std::exp2(stops), kMiddleGrey, 0.04f * kMiddleGrey);  // rounded to .1 stops
        EXPECT_NEAR(stops * 10, std::round(stops * 10), 1e-4f);
    }
    // A mean of logarithms: two stops up and two down are none.
    EXPECT_NEAR(stopsOf(variedPicture(kMiddleGrey)), 0, 0.11f);
}

TEST(AutoExposure, FollowsTheLight) {
    const float once = stopsOf(variedPicture(1));
    for (const int stops : {-12, -3, 1, 9})
        EXPECT_NEAR(stopsOf(variedPicture(std::exp2(float(stops)))), once - float(stops), 1e-4f);
}

TEST(AutoExposure, IsOfTheMeteredPixels) {
    Image picture(10, 10, glm::vec3(0.1f));
    std::vector<uint32_t> metered;
    for (uint32_t i = 0; i < 100; ++i)
        if (i % 3 == 0)
            picture.pixels[i] = glm::vec3(500);  // a sky
        else
            metered.push_back(i);
    EXPECT_EQ(autoExposureStops(picture, metered), stopsOf(Image(4, 4, glm::vec3(0.1f))));
    EXPECT_LT(stopsOf(picture), autoExposureStops(picture, metered) - 2);
    // Nothing but a sky.
    EXPECT_NEAR(autoExposureStops(Image(4, 4, glm::vec3(500)), {}), std::log2(kMiddleGrey / 500), 0.06f);
}

TEST(AutoExposure, KeepsHighlightsAndIgnoresABlackBackground) {
    // A tenth in the sun, a thousand times brighter than the rest.
    Image sunny(10, 10, glm::vec3(0.1f));
    for (uint32_t i = 0; i < 10; ++i) sunny.pixels[i] = glm::vec3(100);
    EXPECT_LE(100 * std::exp2(stopsOf(sunny)), 2.1f);
    // Two pixels that shine are none.
    Image sparkling(10, 10, glm::vec3(0.1f));
    sparkling.pixels[3] = sparkling.pixels[77] = glm::vec3(100);
    EXPECT_EQ(stopsOf(sparkling), stopsOf(Image(4, 4, glm::vec3(0.1f))));
    // The black around a thing, and what a few paths leave in it.
    Image lonely(10, 10, glm::vec3(0));
    for (uint32_t i = 0; i < 30; ++i) lonely.pixels[i] = glm::vec3(0.1f);
    for (uint32_t i = 30; i < 60; ++i) lonely.pixels[i] = glm::vec3(1e-8f);
    EXPECT_EQ(stopsOf(lonely), stopsOf(Image(4, 4, glm::vec3(0.1f))));
    EXPECT_EQ(stopsOf(Image(4, 4)), 0);
    EXPECT_EQ(stopsOf(Image()), 0);
    Image broken(4, 4, glm::vec3(0.1f));
    broken.pixels[0] = glm::vec3(NAN);
    broken.pixels[1] = glm::vec3(INFINITY);
    EXPECT_EQ(stopsOf(broken), stopsOf(Image(4, 4, glm::vec3(0.1f))));
}

TEST(AutoExposure, MetersSurfacesInLight) {
    Scene scene;
    addFloor(scene, lambert(0.5f), 2);
    addQuad(scene, emitter(glm::vec3(9)), {0, 0.01f, -1}, {0, 0, 2}, {1, 0, 0});  // its right half
    Camera camera;
    camera.yfovRadians = 1.5f;
    camera.worldFromCamera = {{1, 0, 0, 0}, {0, 0, -1, 0}, {0, 1, 0, 0}, {0, 2, 0, 1}};  // from above
    const RayScene rays(scene);
    for (const int width : {60, 600}) {
        const auto pixels = meteredPixels(rays, camera, width, width);
        ASSERT_FALSE(pixels.empty());
        EXPECT_LT(pixels.size(), 70'000u);
        for (const uint32_t pixel : pixels) {
            EXPECT_LT(pixel % uint32_t(width), uint32_t(width) / 2 + 1);
            EXPECT_GT(pixel % uint32_t(width), uint32_t(width) / 8);
        }
    }
}

}  // namespace
}  // namespace phat
