#include "core/render/metrics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace phat {
namespace {

TEST(Metrics, EqualPicturesHaveNoError) {
    const Image image(5, 4, {0.2f, 3, 0});
    const Metrics metrics = compareImages(image, image);
    EXPECT_EQ(metrics.relMse, 0);
    EXPECT_EQ(metrics.maeOverMean, 0);
    EXPECT_EQ(metrics.bias, 0);
    EXPECT_EQ(metrics.flip, 0);
    EXPECT_EQ(metrics.pixels, 20u);
}

// Two pixels, reference 1 and 3 (mean 2), test 2 and 2.
TEST(Metrics, ClosedForms) {
    Image reference(2, 1), test(2, 1, glm::vec3(2));
    reference.pixels = {glm::vec3(1), glm::vec3(3)};
    const Metrics metrics = compareImages(test, reference);
    EXPECT_DOUBLE_EQ(metrics.relMse, (1 / 1.04 + 1 / 9.04) / 2);
    EXPECT_DOUBLE_EQ(metrics.maeOverMean, 0.5);
    EXPECT_DOUBLE_EQ(metrics.bias, 0);
}

// A normal deviate's mean size is sqrt(2 / pi) of its sigma: here 1 and 3 over a mean of 2, or 3 over 3.
TEST(Metrics, NoiseOfAReference) {
    Image reference(2, 1), variance(2, 1), mask(2, 1);
    reference.pixels = {glm::vec3(1), glm::vec3(3)};
    variance.pixels = {glm::vec3(1), glm::vec3(9)};
    mask.pixels = {glm::vec3(0), glm::vec3(1)};
    EXPECT_NEAR(noiseOverMean(reference, variance), std::sqrt(2 / M_PI), 1e-6);
    EXPECT_NEAR(noiseOverMean(reference, variance, &mask), std::sqrt(2 / M_PI), 1e-6);
    variance.pixels[0] = glm::vec3(0);
    EXPECT_NEAR(noiseOverMean(reference, variance), 0.75 * std::sqrt(2 / M_PI), 1e-6);
}

TEST(Metrics, BiasHasASign) {
    const Image reference(3, 3, glm::vec3(2));
    EXPECT_DOUBLE_EQ(compareImages(Image(3, 3, glm::vec3(2.5f)), reference).bias, 0.25);
    EXPECT_DOUBLE_EQ(compareImages(Image(3, 3, glm::vec3(1.5f)), reference).bias, -0.25);
}

TEST(Metrics, ChannelsCountEqually) {
    const Image reference(2, 2, {1, 2, 3});
    for (int c = 0; c < 3; ++c) {
        Image test = reference;
        for (glm::vec3& pixel : test.pixels) pixel[c] += 0.5f;
        const double b = c + 1.0;
        const Metrics metrics = compareImages(test, reference);
        EXPECT_DOUBLE_EQ(metrics.relMse, 0.25 / (b * b + 0.04) / 3);
        EXPECT_DOUBLE_EQ(metrics.maeOverMean, 0.5 / 3 / 2);
        EXPECT_DOUBLE_EQ(metrics.bias, 0.5 / 3 / 2);
    }
}

TEST(Metrics, ScaleOfBothPicturesDoesNotMatter) {
    Image reference(4, 1), test(4, 1);
    for (int x = 0; x < 4; ++x) {
        reference.at(x, 0) = glm::vec3(0.1f + float(x), 0.5f, 0.25f * float(x));
        test.at(x, 0) = glm::vec3(0.3f, float(x), 0.7f);
    }
    const Metrics one = compareImages(test, reference);
    for (glm::vec3& pixel : reference.pixels) pixel *= 64;
    for (glm::vec3& pixel : test.pixels) pixel *= 64;
    const Metrics scaled = compareImages(test, reference);
    EXPECT_DOUBLE_EQ(scaled.relMse, one.relMse);
    EXPECT_DOUBLE_EQ(scaled.maeOverMean, one.maeOverMean);
    EXPECT_DOUBLE_EQ(scaled.bias, one.bias);
}

TEST(Metrics, MaskKeepsItsPixelsAlone) {
    Image reference(3, 1), test(3, 1), mask(3, 1);
    reference.pixels = {glm::vec3(1), glm::vec3(3), glm::vec3(100)};
    test.pixels = {glm::vec3(2), glm::vec3(2), glm::vec3(-5)};
    // Exactly one half and what is no number keep nothing; only the first channel speaks.
    mask.pixels = {{0.51f, 0, 0}, {1e30f, 0, 0}, {0.5f, 1, 1}};
    const Metrics metrics = compareImages(test, reference, &mask);
    EXPECT_EQ(metrics.pixels, 2u);
    EXPECT_DOUBLE_EQ(metrics.relMse, (1 / 1.04 + 1 / 9.04) / 2);
    EXPECT_DOUBLE_EQ(metrics.maeOverMean, 0.5);

    mask.pixels[2].x = std::numeric_limits<float>::quiet_NaN();
    EXPECT_EQ(compareImages(test, reference, &mask).pixels, 2u);
    mask.pixels[2].x = std::numeric_limits<float>::infinity();
    EXPECT_EQ(compareImages(test, reference, &mask).pixels, 3u);
    EXPECT_EQ(compareImages(test, reference, nullptr).pixels, 3u);
    const Image nothing(3, 1);
    EXPECT_EQ(compareImages(test, reference, &nothing).pixels, 0u);
}

TEST(Metrics, BlackReferenceDividesNothingByZero) {
    const Image black(2, 2);
    EXPECT_EQ(compareImages(black, black).relMse, 0);
    EXPECT_EQ(compareImages(black, black).bias, 0);
    const Metrics metrics = compareImages(Image(2, 2, glm::vec3(1)), black);
    EXPECT_TRUE(std::isinf(metrics.relMse));
    EXPECT_TRUE(std::isinf(metrics.maeOverMean));
    EXPECT_TRUE(std::isinf(metrics.bias));
}

TEST(Metrics, CountsPixelsThatAreNoNumbers) {
    Image image(3, 1);
    EXPECT_EQ(countNonFinite(image), 0u);
    image.at(0, 0).y = std::numeric_limits<float>::quiet_NaN();
    image.at(2, 0) = glm::vec3(-std::numeric_limits<float>::infinity());
    EXPECT_EQ(countNonFinite(image), 2u);
}

}  // namespace
}  // namespace phat
