#include <gtest/gtest.h>

#include "core/base/random.h"
#include "core/scene/brdf.h"
#include "support/direction_density.h"

namespace phat {
namespace {

glm::vec3 eyeAt(float degrees) {
    const float angle = glm::radians(degrees);
    return {std::sin(angle) * std::cos(0.7f), std::sin(angle) * std::sin(0.7f), std::cos(angle)};
}

TEST(BrdfSampling, CosineHemisphereFollowsItsDensity) {
    Rng rng(1);
    expectSamplesFollowDensity([&] { return squareToCosineHemisphere(rng.uniform2()); },
                               squareToCosineHemispherePdf);
}

TEST(BrdfSampling, VisibleNormalsFollowTheirDensity) {
    Rng rng(2);
    for (const float degrees : {0.0f, 45.0f, 80.0f}) {
        for (const float alpha : {0.2f, 0.6f, 1.0f}) {
            SCOPED_TRACE(testing::Message() << degrees << " degrees, alpha " << alpha);
            const glm::vec3 eye = eyeAt(degrees);
            expectSamplesFollowDensity([&] { return squareToVisibleNormal(rng.uniform2(), eye, alpha); },
                                       [&](glm::vec3 h) { return squareToVisibleNormalPdf(h, eye, alpha); });
        }
    }
}

class WholeBrdf : public testing::TestWithParam<Brdf> {};

TEST_P(WholeBrdf, SamplesFollowTheirDensity) {
    Rng rng(3);
    for (const float degrees : {10.0f, 60.0f, 85.0f}) {
        SCOPED_TRACE(degrees);
        const glm::vec3 eye = eyeAt(degrees);
        expectSamplesFollowDensity(
            [&] {
                const float lobe = rng.uniform();
                const BrdfSample sample = sampleBrdf(GetParam(), eye, lobe, rng.uniform2());
                return sample.pdf > 0 ? sample.direction : glm::vec3(0);
            },
            [&](glm::vec3 light) { return sampleBrdfPdf(GetParam(), eye, light); });
    }
}

// The mean sample weight is the albedo, also by brute-force integration over the hemisphere.
TEST_P(WholeBrdf, MeanWeightIsTheAlbedo) {
    constexpr int kSamples = 200000, kGrid = 400;
    for (const float degrees : {5.0f, 50.0f, 80.0f}) {
        SCOPED_TRACE(degrees);
        const glm::vec3 eye = eyeAt(degrees);
        Rng rng(4);
        glm::dvec3 sampled(0);
        for (int i = 0; i < kSamples; ++i) {
            const float lobe = rng.uniform();
            sampled +=
                glm::dvec3(sampleBrdf(GetParam(), eye, lobe, rng.uniform2()).weight) / double(kSamples);
        }
        glm::dvec3 integrated(0);
        for (int i = 0; i < kGrid * kGrid; ++i) {
            const glm::vec2 square = (glm::vec2(i % kGrid, i / kGrid) + 0.5f) / float(kGrid);
            const glm::vec3 light = squareToCosineHemisphere(square);
            integrated +=
                glm::dvec3(evaluateBrdf(GetParam(), eye, light) / squareToCosineHemispherePdf(light)) /
                double(kGrid * kGrid);
        }
        for (int c = 0; c < 3; ++c) {
            EXPECT_NEAR(sampled[c], integrated[c], 0.004);
            EXPECT_LE(sampled[c], 1.002);
            EXPECT_NEAR(sampled[c], double(reflectance(GetParam(), eye)[c]), 0.006);
        }
    }
}

INSTANTIATE_TEST_SUITE_P(
    Materials, WholeBrdf,
    testing::Values(Brdf{.diffuseColor = glm::vec3(0), .f0 = {0.9f, 0.6f, 0.2f}, .alpha = 0.1f},
                    Brdf{.diffuseColor = glm::vec3(0), .f0 = glm::vec3(1), .alpha = 1.0f},
                    Brdf{.diffuseColor = glm::vec3(0.9565f), .f0 = glm::vec3(0.04f), .alpha = 0.25f},
                    Brdf{.diffuseColor = {0.1f, 0.5f, 0.3f}, .f0 = glm::vec3(0.04f), .alpha = 0.09f},
                    Brdf{.diffuseColor = {0.6f, 0.5f, 0.3f},
                         .f0 = glm::vec3(0.04f),
                         .alpha = 0.5f,
                         .clearcoat = 1.0f,
                         .clearcoatAlpha = 0.1f}));

}  // namespace
}  // namespace phat
