#include "core/scene/photometry.h"

#include <gtest/gtest.h>

#include "core/base/random.h"
#include "core/scene/light_punctual.h"
#include "core/scene/lights.h"
#include "core/scene/scene_motion.h"
#include "support/chi_squared.h"
#include "support/photometries.h"
#include "support/scene_builder.h"

namespace phat {
namespace {

using namespace test;

// Where neither the grid's steps nor a pole are.
constexpr float kVertical[] = {0.03f, 0.4f, 0.9f, 1.3f, 1.7f, 2.9f};
constexpr float kHorizontal[] = {0.1f, 1.2f, 2.7f, 4.1f, 6.2f};

glm::vec3 directionOf(float vertical, float horizontal) {
    return {std::sin(vertical) * std::cos(horizontal), std::sin(vertical) * std::sin(horizontal),
            -std::cos(vertical)};
}

// A linear interpolation is off by an eighth of the squared step times the second derivative, which is 20 at
// most for the 20th power (at its steps of a degree) and 4 for the wall washer (at 2 and 5 degrees).
TEST(Photometry, FollowsItsFormulas) {
    for (const PhotometricFormula& formula : photometricFormulas()) {
        const Photometry photometry = photometryOf(formula);
        for (const float v : kVertical)
            for (const float h : kHorizontal)
                EXPECT_NEAR(photometry.at(directionOf(v, h)), formula.value(v, h), 2e-3)
                    << formula.name << ' ' << v << ' ' << h;
        EXPECT_NEAR(photometry.at({0, 0, -1}), formula.value(0, 0), 1e-6) << formula.name;
    }
}

TEST(Photometry, ItsFluxIsTheIntegralOfItsFormula) {
    for (const PhotometricFormula& formula : photometricFormulas()) {
        const Photometry photometry = photometryOf(formula, 300);
        EXPECT_NEAR(photometry.solidAngle(), formula.solidAngle, 2e-3 * formula.solidAngle) << formula.name;
        EXPECT_NEAR(photometry.lumens(), 300 * formula.solidAngle, 0.6 * formula.solidAngle) << formula.name;
    }
}

// Steps so large that it shows where in them a direction is.
Photometry coarse() {
    return Photometry(
        {"coarse", 1, 3, 4, {.2f, 1, 0, .1f, .2f, .1f, .6f, .1f, .2f, 0, .9f, .1f, .2f, .5f, .3f, .1f}});
}

// Counts in cells of equal solid angle; what they should be is the sum of many values of the intensity in
// each.
TEST(Photometry, SamplesByItsIntensity) {
    constexpr int kBands = 24, kSectors = 16, kSamples = 200'000, kInside = 12;
    std::vector<Photometry> photometries = {coarse()};
    for (const PhotometricFormula& formula : photometricFormulas())
        photometries.push_back(photometryOf(formula));
    for (const Photometry& photometry : photometries) {
        std::vector<double> counts(kBands * kSectors), expected(kBands * kSectors);
        Rng rng(7);
        for (int i = 0; i < kSamples; ++i) {
            const glm::vec3 d = photometry.sample(rng.uniform2());
            ASSERT_TRUE(isUnit(d));
            const float turn = std::atan2(d.y, d.x) / (2 * kPi);
            const int band = std::min(int(0.5f * (1 + d.z) * kBands), kBands - 1);
            const int sector = std::min(int((turn - std::floor(turn)) * kSectors), kSectors - 1);
            ++counts[size_t(band * kSectors + sector)];
        }
        double sum = 0;
        for (int i = 0; i < kBands * kSectors * kInside * kInside; ++i) {
            const int cell = i / (kInside * kInside), x = i % kInside, y = i / kInside % kInside;
            const float z = 2 * (float(cell / kSectors) + (float(y) + 0.5f) / kInside) / kBands - 1;
            const float h = 2 * kPi * (float(cell % kSectors) + (float(x) + 0.5f) / kInside) / kSectors;
            const double value = photometry.at(directionOf(std::acos(-z), h));
            expected[size_t(cell)] += value;
            sum += value;
        }
        for (double& count : expected) count *= kSamples / sum;
        const ChiSquared test = chiSquared(counts, expected);
        EXPECT_LT(test.value, test.limit) << photometry.web().name;
    }
}

TEST(Photometry, TwoAnglesOfANarrowBeam) {
    const Photometry narrow = photometryOf(photometricFormulas()[2]);
    const double half = glm::degrees(std::acos(std::pow(0.5, 1 / 20.0)));
    EXPECT_NEAR(narrow.spreadDegrees(0, 0.5f), 2 * half, 0.25);
    const double tenth = glm::degrees(std::acos(std::pow(0.1, 1 / 20.0)));
    EXPECT_NEAR(narrow.spreadDegrees(90, 0.1f), 2 * tenth, 0.25);
    const Photometry washer = photometryOf(photometricFormulas()[3]);
    EXPECT_GT(washer.spreadDegrees(0, 0.5f), 140);
    EXPECT_EQ(washer.spreadDegrees(90, 0.5f), 0);
}

TEST(Photometry, DarkBelowTheLastLitStep) {
    EXPECT_EQ(photometryOf(photometricFormulas()[0]).darkBelowCosine(), -1);
    EXPECT_NEAR(photometryOf(photometricFormulas()[1]).darkBelowCosine(), 0, 1e-6);
    PhotometricWeb web{"two steps", 1, 9, 1, std::vector<float>(10, 0.0f)};
    web.relative[0] = 1;
    EXPECT_NEAR(Photometry(web).darkBelowCosine(), std::cos(glm::radians(20.0f)), 1e-6);
    EXPECT_EQ(Photometry(web).at(directionOf(glm::radians(20.1f), 0)), 0);
}

// E = I cos / d^2 on a floor 2 m below, at places of it.
TEST(Photometry, LightsAFloorAsTheFormulaSays) {
    for (const PhotometricFormula& formula : photometricFormulas()) {
        Scene scene;
        scene.lights = {photometricLight(photometryOf(formula), glm::vec3(50, 60, 70), {0, 2, 0})};
        const LightSampler lights(scene);
        for (const glm::vec3 place : {glm::vec3(0.3f, 0, 0), {1, 0, 0}, {0.7f, 0, -1.1f}, {-2, 0, 0.4f}}) {
            const LightSample sample = lights.samplePunctual(0, place);
            const double d2 = double(glm::dot(place, place)) + 4, cosine = 2 / std::sqrt(d2);
            // Horizontal angle 0 is +x, 90 degrees -z.
            const double expected =
                60 * formula.value(std::acos(cosine), std::atan2(-place.z, place.x)) * cosine / d2;
            EXPECT_NEAR(sample.radiance.y * sample.towardLight.y, expected, 5e-3 * 60 * cosine / d2)
                << formula.name << ' ' << place.x << ' ' << place.z;
        }
    }
}

// The flux of photons on squares of the floor against the integral of the irradiance that samplePunctual
// says.
TEST(Photometry, PhotonsCarryWhatIsEvaluated) {
    constexpr int kSide = 8, kInside = 16;
    constexpr float kSize = 0.75f;
    constexpr uint64_t kPhotons = 400'000;
    for (const PhotometricFormula& formula : photometricFormulas()) {
        Scene scene;
        scene.lights = {photometricLight(photometryOf(formula), glm::vec3(2), {0.2f, 2, -0.1f})};
        // Turned about the vertical, so that no axis of the photometry is one of the squares'.
        scene.lights[0].horizontalZero = glm::normalize(glm::vec3(2, 0, 1));
        const LightSampler lights(scene);
        std::vector<double> flux(kSide * kSide), expected(kSide * kSide);
        double total = 0;
        for (uint64_t i = 0; i < kPhotons; ++i) {
            const EmittedPhoton photon = lights.emitPhoton(i, kPhotons, 3);
            total += photon.fluxWatts.x;
            if (!(photon.direction.y < 0)) continue;
            const glm::vec3 place = photon.origin - photon.direction * (photon.origin.y / photon.direction.y);
            const int x = int(std::floor(place.x / kSize)) + kSide / 2,
                      z = int(std::floor(place.z / kSize)) + kSide / 2;
            if (x >= 0 && x < kSide && z >= 0 && z < kSide) flux[size_t(z * kSide + x)] += photon.fluxWatts.x;
        }
        EXPECT_NEAR(total, 2 * formula.solidAngle, 2e-3 * total) << formula.name;
        const float part = kSize / kInside;
        for (int z = 0; z < kSide * kInside; ++z)
            for (int x = 0; x < kSide * kInside; ++x) {
                const glm::vec3 place((float(x) + 0.5f) * part - kSize * kSide / 2, 0,
                                      (float(z) + 0.5f) * part - kSize * kSide / 2);
                const LightSample sample = lights.samplePunctual(0, place);
                expected[size_t(z / kInside * kSide + x / kInside)] +=
                    double(sample.radiance.x) * std::max(0.0f, sample.towardLight.y) * part * part;
            }
        // Six deviations of as many independent photons; theirs are spread more evenly.
        for (size_t i = 0; i < flux.size(); ++i)
            EXPECT_NEAR(flux[i], expected[i], 6 * std::sqrt(expected[i] * total / kPhotons) + 1e-4 * total)
                << formula.name << ' ' << i;
    }
}

TEST(Photometry, TurnsWithItsNode) {
    const PhotometricFormula washer = photometricFormulas()[3];
    const PunctualLight light = photometricLight(photometryOf(washer), glm::vec3(1), glm::vec3(0));
    const glm::vec3 lit = glm::normalize(glm::vec3(1, -1, 0)), dark = glm::normalize(glm::vec3(0, -1, 1));
    EXPECT_NEAR(photometricFalloff(light, lit), 1, 1e-3);
    EXPECT_NEAR(photometricFalloff(light, dark), 0, 1e-6);
    glm::mat4 quarter(0);  // about the vertical: x becomes -z
    quarter[0] = {0, 0, -1, 0}, quarter[1] = {0, 1, 0, 0}, quarter[2] = {1, 0, 0, 0}, quarter[3].w = 1;
    const PunctualLight moved = movedLights({light}, std::vector<glm::mat4>{quarter}).front();
    EXPECT_NEAR(photometricFalloff(moved, lit), 0, 1e-6);
    EXPECT_NEAR(photometricFalloff(moved, dark), 1, 1e-3);
}

}  // namespace
}  // namespace phat
