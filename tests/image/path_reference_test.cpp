// Pictures of the path tracer against stored ones of many samples: blocks of pixels, and the mean of the
// whole. source: the render tests of Mitsuba 3 (Jakob et al. 2022): a reference with its variance, a z-test,
// a Sidak-corrected level. They judge pixels; a z-test holds for normal means, and a few bright samples among
// many dark ones, as a lamp in a glossy surface gives, are far from that at hundreds of samples. Blocks have
// enough.

#include <gtest/gtest.h>

#include "core/path_tracer.h"
#include "io/gltf_loader.h"
#include "io/image_file.h"

namespace phat {
namespace {

constexpr double kLevel = 0.01;  // of the family of tests, as Mitsuba's
// Blocks of 8 pixels, of 16,000 samples, are not yet normal: two of eight seeds failed on cornell-glossy.
constexpr int kBlockSide = 16, kWholePicture = 64;
constexpr int kStoredSamples = 4096, kSamples = 256;

// Of `tests` independent two-sided tests each gets this level. source: Sidak 1967.
double sidakLevel(double tests) {
    return 1 - std::pow(1 - kLevel, 1 / tests);
}

// How likely the mean of many samples is to be off by `difference`.
double pValue(double difference, double variance) {
    return std::erfc(std::abs(difference) / std::sqrt(2 * variance));
}

/// The least p of a family of tests, and the level that it must reach.
struct Verdict {
    double lowestP = 1;
    double level = 0;

    bool passes() const { return lowestP >= level; }
};

/// Means over blocks of `side` pixels.
Verdict judge(const Image& test, const Image& stored, const Image& storedVariance, int side) {
    // The variance comes from the stored picture, which has the samples to know it.
    constexpr double kOfDifference = 1 + double(kStoredSamples) / kSamples;
    Verdict verdict;
    int tests = 0;
    for (int top = 0; top < test.height; top += side)
        for (int left = 0; left < test.width; left += side)
            for (int c = 0; c < 3; ++c, ++tests) {
                double difference = 0, variance = 0;
                for (int y = top; y < std::min(top + side, test.height); ++y)
                    for (int x = left; x < std::min(left + side, test.width); ++x) {
                        difference += double(test.at(x, y)[c]) - double(stored.at(x, y)[c]);
                        // Without noise (the sight of the lamp) pictures agree to float rounding.
                        const double rounding = 1e-5 * double(stored.at(x, y)[c]);
                        variance += double(storedVariance.at(x, y)[c]) * kOfDifference + rounding * rounding;
                    }
                if (difference != 0)
                    verdict.lowestP = std::min(verdict.lowestP, pValue(difference, variance));
            }
    verdict.level = sidakLevel(tests);
    return verdict;
}

struct Case {
    Image stored, variance;
    Scene scene;
};

Case load(const std::string& name) {
    const std::string stored = PHAT_SOURCE_DIR "/tests/data/path/" + name;
    return {readExr(stored + ".exr"), readExr(stored + ".variance.exr"),
            loadGltf(PHAT_SOURCE_DIR "/scenes/" + name + ".glb").scene};
}

Image trace(const Case& of, float lampBrightness) {
    Scene scene = of.scene;
    for (Material& material : scene.materials) material.emission *= lampBrightness;
    const RayScene rays(scene);
    const LightSampler lights(scene);
    PictureSettings settings;
    settings.width = of.stored.width;
    settings.height = of.stored.height;
    settings.camera = scene.cameras.at(0);
    settings.samplesPerPixel = kSamples;
    settings.seed = 2;  // the stored one's is 1
    SilentProgress silent;
    return tracePicture(settings, pathTracer(rays, lights, Component::all), silent).mean;
}

class PathReference : public testing::TestWithParam<const char*> {};

TEST_P(PathReference, IsMatchedAndSmallChangesAreNoticed) {
    const Case of = load(GetParam());
    Image got = trace(of, 1);
    const Image brighter = trace(of, 1.02f);
    for (const int side : {kBlockSide, kWholePicture}) {
        const Verdict same = judge(got, of.stored, of.variance, side);
        EXPECT_TRUE(same.passes()) << side << ": " << same.lowestP << " < " << same.level;
    }
    EXPECT_FALSE(judge(brighter, of.stored, of.variance, kWholePicture).passes()) << "two percent more light";
    std::rotate(got.pixels.begin(), got.pixels.begin() + 1, got.pixels.end());
    EXPECT_FALSE(judge(got, of.stored, of.variance, kBlockSide).passes()) << "a picture moved by one pixel";
}

INSTANTIATE_TEST_SUITE_P(Scenes, PathReference, testing::Values("cornell-glossy", "tabletop"));

}  // namespace
}  // namespace phat
