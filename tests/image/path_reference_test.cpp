// Pictures of the path tracer against stored ones of many samples, by a z-test of every pixel and of the
// whole. source: the render tests of Mitsuba 3 (Jakob et al. 2022): a reference with its variance, a
// Sidak-corrected level and a share of pixels that must pass. The whole picture's test is ours: it sees what
// is too little for a pixel.

#include <gtest/gtest.h>

#include "core/path_tracer.h"
#include "io/gltf_loader.h"
#include "io/image_file.h"

namespace phat {
namespace {

// As Mitsuba's tests: the level of the family, and the share of pixels that must pass.
constexpr double kLevel = 0.01;
constexpr double kAcceptedShare = 0.9975;

constexpr int kStoredSamples = 4096, kSamples = 256;

// Of `tests` independent two-sided tests each gets this level. source: Sidak 1967.
double sidakLevel(double tests) {
    return 1 - std::pow(1 - kLevel, 1 / tests);
}

double pValue(double z) {
    return std::erfc(std::abs(z) / std::sqrt(2.0));
}

struct Verdict {
    double acceptedShare = 0;     // of the pixels' channels
    double lowestPOfPicture = 1;  // of the three channels' means
};

// The variance of a single sample comes from the stored picture, which has enough of them to know it.
Verdict judge(const Image& test, const Image& stored, const Image& storedVariance) {
    constexpr double kOfDifference = 1 + double(kStoredSamples) / kSamples;
    const auto count = double(test.pixels.size());
    size_t accepted = 0;
    Verdict verdict;
    for (int c = 0; c < 3; ++c) {
        double difference = 0, variance = 0;
        for (size_t i = 0; i < test.pixels.size(); ++i) {
            const double d = double(test.pixels[i][c]) - double(stored.pixels[i][c]);
            // Pixels without noise (the sight of the lamp) agree to float rounding.
            const double rounding = 1e-5 * double(stored.pixels[i][c]);
            const double v =
                double(storedVariance.pixels[i][c]) * kOfDifference + rounding * rounding + 1e-20;
            accepted += pValue(d / std::sqrt(v)) >= sidakLevel(3 * count);
            difference += d;
            variance += v;
        }
        verdict.lowestPOfPicture =
            std::min(verdict.lowestPOfPicture, pValue(difference / std::sqrt(variance)));
    }
    verdict.acceptedShare = double(accepted) / (3 * count);
    return verdict;
}

Verdict judgeScene(const std::string& name, float lampBrightness) {
    const std::string stored = PHAT_SOURCE_DIR "/tests/data/path/" + name;
    const Image want = readExr(stored + ".exr"), variance = readExr(stored + ".variance.exr");
    Scene scene = loadGltf(PHAT_SOURCE_DIR "/scenes/" + name + ".glb").scene;
    for (Material& material : scene.materials) material.emission *= lampBrightness;
    const RayScene rays(scene);
    const LightSampler lights(scene);
    PictureSettings settings;
    settings.width = want.width;
    settings.height = want.height;
    settings.camera = scene.cameras.at(0);
    settings.samplesPerPixel = kSamples;
    settings.seed = 2;  // the stored one's is 1
    SilentProgress silent;
    const TracedPicture got = tracePicture(settings, pathTracer(rays, lights, Component::all), silent);
    return judge(got.mean, want, variance);
}

class PathReference : public testing::TestWithParam<const char*> {};

TEST_P(PathReference, IsMatchedAndTwoPercentMoreLightIsNoticed) {
    const Verdict same = judgeScene(GetParam(), 1);
    EXPECT_GE(same.acceptedShare, kAcceptedShare);
    EXPECT_GE(same.lowestPOfPicture, sidakLevel(3));
    const Verdict brighter = judgeScene(GetParam(), 1.02f);
    EXPECT_LT(brighter.lowestPOfPicture, sidakLevel(3));
}

INSTANTIATE_TEST_SUITE_P(Scenes, PathReference, testing::Values("cornell-glossy", "tabletop"));

}  // namespace
}  // namespace phat
