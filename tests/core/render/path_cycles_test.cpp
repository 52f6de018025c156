// The path tracer against another one, within the noise of both.

#include <gtest/gtest.h>

#include "core/render/path_tracer.h"
#include "io/gltf/gltf_loader.h"
#include "io/image/image_file.h"

namespace phat {
namespace {

constexpr int kSamples = 32;
// Of the reference, and how much less noise its samples have than ours: 2.6 / 6.1, relMSE times samples
// (docs/reference.md, "Path tracer").
constexpr double kReferenceSamples = 1024, kReferenceNoise = 0.43;

double grey(glm::vec3 color) {
    return double(color.x + color.y + color.z) / 3;
}

// A pixel's own variance will not do: where a pixel missed the rare bright paths, mean and variance are too
// small together. Its neighbours' mean has other samples of nearly the same light.
double varianceAround(const Image& variance, int x, int y, int reach) {
    double sum = 0;
    int count = 0;
    for (int ny = std::max(y - reach, 0); ny <= std::min(y + reach, variance.height - 1); ++ny)
        for (int nx = std::max(x - reach, 0); nx <= std::min(x + reach, variance.width - 1); ++nx, ++count)
            sum += grey(variance.at(nx, ny));
    return sum / count;
}

double fractionInside(const TracedPicture& traced, const Image& reference, double sigmas, float scale) {
    double inside = 0;
    for (int y = 0; y < reference.height; ++y)
        for (int x = 0; x < reference.width; ++x) {
            const double variance = varianceAround(traced.variance, x, y, 2) *
                                    (1 + kSamples / kReferenceSamples * kReferenceNoise);
            const double rounding = 1e-4 * grey(reference.at(x, y));
            const double difference = grey(scale * traced.mean.at(x, y)) - grey(reference.at(x, y));
            inside += std::abs(difference) <= sigmas * std::sqrt(variance) + rounding;
        }
    return inside / double(reference.pixels.size());
}

TEST(PathCycles, CornellIsInsideFourSigmas) {
    const Image reference = readExr(PHAT_SOURCE_DIR "/tests/data/references/cornell-glossy.exr");
    const Scene scene = loadGltf(PHAT_SOURCE_DIR "/scenes/cornell-glossy.glb").scene;
    const RayScene rays(scene);
    const LightSampler lights(scene);
    PictureSettings settings;
    settings.width = reference.width;
    settings.height = reference.height;
    settings.camera = scene.cameras.at(0);
    settings.samplesPerPixel = kSamples;
    SilentProgress silent;
    const TracedPicture traced = tracePicture(settings, pathTracer(rays, lights, Component::all), silent);

    EXPECT_GE(fractionInside(traced, reference, 4, 1), 0.99);
    // The test of the test: the band is no wider than the noise, and a dimmer picture leaves it.
    EXPECT_LT(fractionInside(traced, reference, 1, 1), 0.9);
    EXPECT_LT(fractionInside(traced, reference, 4, 0.7f), 0.99);
    double sum = 0, expected = 0, variance = 0;
    for (size_t i = 0; i < reference.pixels.size(); ++i) {
        sum += grey(traced.mean.pixels[i]);
        expected += grey(reference.pixels[i]);
        variance += grey(traced.variance.pixels[i]);
    }
    // The channels are nearly one, so the mean of their variances is that of their mean, at most.
    EXPECT_NEAR(sum, expected, 4 * std::sqrt(variance) + 2e-3 * expected);
}

}  // namespace
}  // namespace phat
