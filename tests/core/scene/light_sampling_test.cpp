#include <gtest/gtest.h>

#include <numeric>

#include "core/scene/light_punctual.h"
#include "core/scene/lights.h"
#include "support/chi_squared.h"
#include "support/scene_builder.h"

namespace phat {
namespace {

using namespace test;

// Bins of equal solid angle over the sphere: cosine of the polar angle about +Y times azimuth.
constexpr int kRings = 24, kSectors = 48, kBins = kRings * kSectors;

int binOf(glm::vec3 direction) {
    const int ring = std::clamp(int((1 - direction.y) / 2 * kRings), 0, kRings - 1);
    const float turn = std::atan2(direction.z, direction.x) / (2 * kPi) + 0.5f;
    return ring * kSectors + std::clamp(int(turn * kSectors), 0, kSectors - 1);
}

// Midpoint rule over every bin; at the sharp edges of lights its error is far below the samples' own noise.
template <typename Pdf>
std::vector<double> integrateBins(Pdf pdf, int perSide) {
    std::vector<double> integral(kBins, 0.0);
    const int rings = kRings * perSide, sectors = kSectors * perSide;
    for (int y = 0; y < rings; ++y) {
        for (int x = 0; x < sectors; ++x) {
            const double cosine = 1 - 2 * (y + 0.5) / rings, sine = std::sqrt(1 - cosine * cosine);
            const double azimuth = ((x + 0.5) / sectors - 0.5) * 2 * double(kPi);
            const glm::vec3 direction(sine * std::cos(azimuth), cosine, sine * std::sin(azimuth));
            integral[(y / perSide) * kSectors + x / perSide] +=
                double(pdf(direction)) * 4 * double(kPi) / (double(rings) * sectors);
        }
    }
    return integral;
}

void expectDistribution(std::vector<double> counts, std::vector<double> probabilities, int samples) {
    for (double& p : probabilities) p *= samples;
    const ChiSquared result = chiSquared(counts, probabilities);
    EXPECT_LT(result.value, result.limit) << result.degreesOfFreedom;
}

Environment roughSky(int width, int height) {
    Environment sky{Image(width, height)};
    Rng rng(11);
    for (glm::vec3& pixel : sky.radiance.pixels) {
        const float u = rng.uniform();
        pixel = u < 0.5f ? glm::vec3(0) : glm::vec3(u, rng.uniform(), rng.uniform());
    }
    sky.radiance.at(width / 3, height / 4) = glm::vec3(400);  // a sun
    return sky;
}

// Three emitters around `kEye` that do not hide one another: one-sided, double-sided and of another power,
// and one that shows only its dark back.
const glm::vec3 kEye(0.1f, 0.2f, -0.1f);

Scene manyLights() {
    Scene scene;
    addCeiling(scene, emitter({5, 5, 5}), 1.5f, 1.2f);
    Material blade = emitter({1, 2, 0});
    blade.doubleSided = true;
    addQuad(scene, blade, {1, -1, -1}, {0.3f, 1, 0.2f}, {0, 0.3f, 2});
    addQuad(scene, emitter({9, 9, 9}), {-1, -1, -1}, {0, 0, 1}, {0, 1, 0});
    return scene;
}

// Nine bins a texel, in which the pdf is constant: their probabilities are exact, the sun's edges too.
TEST(EnvironmentSampling, FollowsItsPdf) {
    constexpr int kWidth = 16, kHeight = 8, kColumns = 3 * kWidth, kRows = 3 * kHeight;
    const Environment sky = roughSky(kWidth, kHeight);
    const EnvironmentDistribution distribution(sky);
    std::vector<double> expected, counts(kColumns * kRows, 0.0);
    for (int y = 0; y < kRows; ++y) {
        const double step = double(kPi) / kRows, polar = (y + 0.5) * step;
        const double solidAngle =
            (std::cos(y * step) - std::cos((y + 1) * step)) * 2 * double(kPi) / kColumns;
        for (int x = 0; x < kColumns; ++x) {
            const double azimuth = ((x + 0.5) / kColumns - 0.5) * 2 * double(kPi), sine = std::sin(polar);
            const glm::vec3 center(sine * std::cos(azimuth), std::cos(polar), sine * std::sin(azimuth));
            expected.push_back(distribution.pdf(center) * solidAngle);
        }
    }
    EXPECT_NEAR(std::accumulate(expected.begin(), expected.end(), 0.0), 1.0, 1e-5);
    constexpr int kSamples = 200'000;
    Rng rng(5);
    for (int i = 0; i < kSamples; ++i) {
        const glm::vec3 d = distribution.sample(rng.uniform2()).direction;
        const int x = int((std::atan2(d.z, d.x) / (2 * kPi) + 0.5f) * kColumns);
        const int y = int(std::acos(d.y) / kPi * kRows);
        counts[std::clamp(y, 0, kRows - 1) * kColumns + std::clamp(x, 0, kColumns - 1)] += 1;
    }
    expectDistribution(counts, expected, kSamples);
}

TEST(EnvironmentSampling, SamplesKnowTheirPdfAndTheIntegral) {
    const Environment sky = roughSky(31, 14);
    const EnvironmentDistribution distribution(sky);
    // E[L / pdf] is the integral of the bilinear radiance, which the constructor gives in closed form.
    Rng rng(3);
    double sum = 0, squares = 0;
    constexpr int kSamples = 200'000;
    for (int i = 0; i < kSamples; ++i) {
        const EnvironmentSample sample = distribution.sample(rng.uniform2());
        ASSERT_GT(sample.pdf, 0.0f);
        ASSERT_NEAR(glm::length(sample.direction), 1.0f, 1e-5f);
        // A direction on the seam of two texels may be looked up in the other one.
        const glm::vec3 nudged = glm::normalize(sample.direction + glm::vec3(1e-5f));
        if (distribution.pdf(nudged) == distribution.pdf(sample.direction)) {
            ASSERT_NEAR(distribution.pdf(sample.direction), sample.pdf, 1e-4f * sample.pdf);
        }
        const double value = environmentRadiance(sky, sample.direction).y / sample.pdf;
        sum += value;
        squares += value * value;
    }
    const double mean = sum / kSamples, error = std::sqrt((squares / kSamples - mean * mean) / kSamples);
    EXPECT_NEAR(mean, distribution.integratedRadiance().y, 4 * error);
    EXPECT_LT(error, 0.005 * mean);
}

// Wherever a lookup finds light, there is a chance of sampling it.
TEST(EnvironmentSampling, NoLightIsOutOfReach) {
    Environment sky{Image(16, 8)};
    sky.radiance.at(0, 0) = glm::vec3(1);
    sky.radiance.at(9, 5) = glm::vec3(1);
    const EnvironmentDistribution distribution(sky);
    Rng rng(4);
    int lit = 0;
    for (int i = 0; i < 200'000; ++i) {
        const float z = 1 - 2 * rng.uniform(), turn = 2 * kPi * rng.uniform(), s = std::sqrt(1 - z * z);
        const glm::vec3 direction(s * std::cos(turn), z, s * std::sin(turn));
        if (environmentRadiance(sky, direction).x <= 1e-4f) continue;
        ++lit;
        ASSERT_GT(distribution.pdf(direction), 0.0f);
    }
    EXPECT_GT(lit, 1000);
}

TEST(LightSampling, DirectionsFollowTheirPdf) {
    for (bool withSky : {false, true}) {
        Scene scene = manyLights();
        if (withSky) scene.environment = roughSky(12, 6);
        const LightSampler lights(scene);
        const RayScene rays(scene);
        const auto pdf = [&](glm::vec3 direction) {
            const Hit hit = rays.closestHit(kEye, direction);
            return lights.sampleAreaPdf(kEye, hit, direction) + lights.sampleEnvironmentPdf(direction);
        };
        std::vector<double> expected = integrateBins(pdf, 24);
        // The triangles that face away are chosen too, and give no sample.
        constexpr int kSamples = 200'000;
        int none = 0;
        std::vector<double> counts(kBins, 0.0);
        Rng rng(6);
        for (int i = 0; i < kSamples; ++i) {
            const float choice = rng.uniform();
            const LightSample sample = lights.sampleArea(kEye, choice, rng.uniform2());
            if (sample.pdf > 0) {
                counts[binOf(sample.towardLight)] += 1;
            } else {
                ++none;
            }
        }
        const double seen = std::accumulate(expected.begin(), expected.end(), 0.0);
        EXPECT_NEAR(seen, 1.0 - double(none) / kSamples, 6e-3);  // edges of the grid and 4 sd of the count
        counts.push_back(none);
        expected.push_back(1.0 - seen);
        expectDistribution(counts, expected, kSamples);
    }
}

TEST(LightSampling, SamplingAndHittingAgreeOnThePdf) {
    Scene scene = manyLights();
    const LightSampler lights(scene);
    const RayScene rays(scene);
    Rng rng(8);
    int compared = 0;
    for (int i = 0; i < 20'000; ++i) {
        const float choice = rng.uniform();
        const LightSample sample = lights.sampleArea(kEye, choice, rng.uniform2());
        if (!(sample.pdf > 0)) continue;
        const Hit hit = rays.closestHit(kEye, sample.towardLight);
        // On an edge the ray may find the neighbour or nothing.
        if (!hit || std::abs(hit.distance - sample.distance) > 1e-4f) continue;
        const SurfacePoint point = surfaceAt(scene, hit, sample.towardLight);
        const bool edge = std::min({hit.barycentric.x, hit.barycentric.y,
                                    1 - hit.barycentric.x - hit.barycentric.y}) < 1e-4f;
        if (edge) continue;
        ++compared;
        ASSERT_NEAR(lights.sampleAreaPdf(kEye, hit, sample.towardLight), sample.pdf, 1e-3f * sample.pdf);
        ASSERT_EQ(point.emission, sample.radiance);
    }
    EXPECT_GT(compared, 5000);
}

// Configuration factor of a parallel unit square at unit distance over its centre: .23945; times 5 nit of
// radiance and a white Lambert surface's pi / pi. source: Howell, "A Catalog of Radiation Heat Transfer
// Configuration Factors", B-4 (four quarters).
TEST(LightSampling, SquareLampOverAWhitePlane) {
    Scene scene;
    addCeiling(scene, emitter(glm::vec3(5)), 1, 1);
    const LightSampler lights(scene);
    Rng rng(1);
    double sum = 0, squares = 0;
    constexpr int kSamples = 400'000;
    for (int i = 0; i < kSamples; ++i) {
        const float choice = rng.uniform();
        const LightSample sample = lights.sampleArea(glm::vec3(0), choice, rng.uniform2());
        const double value = sample.radiance.x * sample.towardLight.y / sample.pdf / double(kPi);
        sum += value;
        squares += value * value;
    }
    const double mean = sum / kSamples, error = std::sqrt((squares / kSamples - mean * mean) / kSamples);
    EXPECT_NEAR(mean, 1.19726, 4 * error);
    EXPECT_LT(error, 1e-3);
}

// Low-discrepancy directions fill the bins more evenly than random ones: chi-squared bounds them from above.
TEST(PhotonEmission, PointLightsShineEverywhereAlike) {
    Scene scene;
    scene.lights = {pointLight(glm::vec3(1), {1, 2, 3})};
    const LightSampler lights(scene);
    constexpr int kPhotons = 200'000;
    std::vector<double> counts(kBins, 0.0);
    for (int i = 0; i < kPhotons; ++i) {
        const EmittedPhoton photon = lights.emitPhoton(i, kPhotons, 3);
        ASSERT_EQ(photon.origin, glm::vec3(1, 2, 3));
        ASSERT_TRUE(photon.punctual);
        counts[binOf(photon.direction)] += 1;
    }
    expectDistribution(counts, std::vector<double>(kBins, 1.0 / kBins), kPhotons);
}

TEST(PhotonEmission, SpotLightsFollowTheirFalloff) {
    Scene scene;
    scene.lights = {spotLight(glm::vec3(1), glm::vec3(0), glm::normalize(glm::vec3(1, 2, -1)), 20, 50)};
    const LightSampler lights(scene);
    const SpotCone cone = spotCone(scene.lights[0]);
    constexpr int kPhotons = 200'000;
    std::vector<double> counts(kBins, 0.0);
    for (int i = 0; i < kPhotons; ++i) counts[binOf(lights.emitPhoton(i, kPhotons, 3).direction)] += 1;
    const auto pdf = [&](glm::vec3 d) {
        return spotFalloff(cone, glm::dot(d, scene.lights[0].direction)) / spotSolidAngle(cone);
    };
    expectDistribution(counts, integrateBins(pdf, 24), kPhotons);
}

TEST(PhotonEmission, SurfacesShineByTheCosine) {
    Scene scene;
    Material material = emitter(glm::vec3(1));
    material.doubleSided = true;
    addFloor(scene, material, 1);
    const LightSampler lights(scene);
    constexpr int kPhotons = 200'000;
    std::vector<double> counts(kBins, 0.0), places(64, 0.0);
    for (int i = 0; i < kPhotons; ++i) {
        const EmittedPhoton photon = lights.emitPhoton(i, kPhotons, 3);
        counts[binOf(photon.direction)] += 1;
        const glm::vec2 cell = (glm::vec2(photon.origin.x, photon.origin.z) + 0.5f) * 8.0f;
        places[std::clamp(int(cell.y), 0, 7) * 8 + std::clamp(int(cell.x), 0, 7)] += 1;
    }
    expectDistribution(counts, integrateBins([](glm::vec3 d) { return std::abs(d.y) / (2 * kPi); }, 24),
                       kPhotons);
    expectDistribution(places, std::vector<double>(64, 1.0 / 64), kPhotons);
}

// The flux from each part of the sky, per cross-section of the scene's sphere, is that part's radiance.
TEST(PhotonEmission, TheSkySendsItsRadiance) {
    Scene scene;
    addFloor(scene, lambert(1), 2);  // sphere of radius sqrt(2)
    scene.environment = roughSky(12, 6);
    const LightSampler lights(scene);
    constexpr int kPhotons = 400'000;
    glm::dvec3 sum(0);
    for (int i = 0; i < kPhotons; ++i) {
        const EmittedPhoton photon = lights.emitPhoton(i, kPhotons, 3);
        sum += glm::dvec3(photon.fluxWatts);
        ASSERT_LT(glm::dot(photon.origin, photon.direction), -std::sqrt(2.0f));  // outside of the sphere
        const glm::vec3 across = photon.origin - glm::dot(photon.origin, photon.direction) * photon.direction;
        ASSERT_LT(glm::length(across), std::sqrt(2.0f) * 1.0001f);
        ASSERT_FALSE(photon.punctual);
    }
    // The colours differ within a texel of the sampling: a standard deviation of less than one photon's flux.
    for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(sum[c], lights.powerArea()[c], 4 * lights.powerArea()[c] / std::sqrt(double(kPhotons)))
            << c;
    }
}

}  // namespace
}  // namespace phat
