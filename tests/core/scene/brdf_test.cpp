#include "core/scene/brdf.h"

#include <gtest/gtest.h>

namespace phat {
namespace {

glm::vec3 direction(float degrees, float azimuth = 0.0f) {
    const float angle = glm::radians(degrees);
    return {std::sin(angle) * std::cos(azimuth), std::sin(angle) * std::sin(azimuth), std::cos(angle)};
}

TEST(Brdf, IsReciprocalWhereTheAlbedoNeedsNoHolding) {
    const Brdf brdf{.diffuseColor = {0.5f, 0.4f, 0.3f}, .f0 = glm::vec3(0.04f), .alpha = 0.3f};
    const glm::vec3 a = direction(20), b = direction(50, 2.0f);
    const glm::vec3 forward = evaluateBrdf(brdf, a, b) / b.z;
    const glm::vec3 backward = evaluateBrdf(brdf, b, a) / a.z;
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(forward[c], backward[c], 1e-6f);
}

// alpha = 1 seen head-on has a closed form: D = 1 / pi, V = .5 / (1 + n.l), so the albedo is the integral of
// m / (1 + m) over m in [0, 1], 1 - ln 2. A mirror loses nothing; in between more roughness loses more.
TEST(Brdf, WhiteMetalLosesWhatSingleScatteringLoses) {
    EXPECT_NEAR(specularAlbedo(glm::vec3(1), 1, 1, 1).x, 1 - std::log(2.0f), 2e-3f);
    float last = 1.001f;
    for (const float alpha : {kMinAlpha, 0.01f, 0.09f, 0.36f, 0.7f, 1.0f}) {
        const float albedo = specularAlbedo(glm::vec3(1), 1, alpha, 0.5f).x;
        EXPECT_LT(albedo, last);
        last = albedo;
    }
    EXPECT_NEAR(specularAlbedo(glm::vec3(1), 1, kMinAlpha, 0.5f).x, 1, 1e-3f);
}

TEST(Brdf, NeverReflectsMoreThanArrives) {
    for (const float alpha : {0.01f, 0.09f, 0.36f, 1.0f}) {
        for (float nDotV = 0.02f; nDotV <= 1.0f; nDotV += 0.07f) {
            const Brdf white{
                .diffuseColor = glm::vec3(1 - meanFresnel(0.04f, 1)), .f0 = glm::vec3(0.04f), .alpha = alpha};
            const glm::vec3 sum = diffuseWeight(white, nDotV) * white.diffuseColor +
                                  specularAlbedo(white.f0, white.f90, alpha, nDotV);
            EXPECT_LE(sum.x, 1.0f + 1e-5f);
        }
    }
}

TEST(Brdf, MeanFresnelOfGlassIsThatOfTheReferencePictures) {
    EXPECT_NEAR(1 - meanFresnel(0.04f, 1), 0.9565f, 5e-5f);
}

TEST(Brdf, SplitSumAgreesWithBruteForce) {
    for (const float alpha : {0.05f, 0.25f, 0.8f}) {
        for (const float nDotV : {0.15f, 0.5f, 0.95f}) {
            const glm::vec3 v(std::sqrt(1 - nDotV * nDotV), 0, nDotV);
            // Over visible half vectors on a fine grid, f0 = 1 and f90 = 1: no Fresnel.
            constexpr int kGrid = 500;
            double sum = 0;
            for (int i = 0; i < kGrid * kGrid; ++i) {
                const glm::vec2 s = (glm::vec2(i % kGrid, i / kGrid) + 0.5f) / float(kGrid);
                const glm::vec3 h = squareToVisibleNormal(s, v, alpha);
                const glm::vec3 l = 2 * glm::dot(v, h) * h - v;
                if (l.z > 0) sum += 4 * l.z * v.z * smithV(l.z, v.z, alpha) / smithG1(v.z, alpha);
            }
            const glm::vec2 ab = splitSum(nDotV, alpha);
            EXPECT_NEAR(ab.x + ab.y, sum / (kGrid * kGrid), 2e-3) << alpha << ' ' << nDotV;
        }
    }
}

TEST(Brdf, BelowTheHorizonIsBlack) {
    const Brdf brdf;
    EXPECT_EQ(evaluateBrdf(brdf, {0, 0, 1}, {0.6f, 0, -0.8f}), glm::vec3(0));
    EXPECT_EQ(evaluateBrdf(brdf, {0.6f, 0, -0.8f}, {0, 0, 1}), glm::vec3(0));
    EXPECT_EQ(sampleBrdf(brdf, {0.6f, 0, -0.8f}, 0.5f, {0.5f, 0.5f}).pdf, 0);
}

}  // namespace
}  // namespace phat
