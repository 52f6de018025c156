// From a scene's file to its picture, as a user would, against closed forms and another renderer.

#include <gtest/gtest.h>

#include "core/render/metrics.h"
#include "io/image/image_file.h"
#include "support/run_program.h"

namespace phat {
namespace {

Image bakeAndRender(const std::string& scene, const std::string& resolution, const std::string& size) {
    const TemporaryFolder folder;
    const std::string baked = folder.file("scene.phat.glb"), picture = folder.file("picture.exr");
    const auto bake = runPhat(
        {"bake", PHAT_SOURCE_DIR "/scenes/" + scene, "-o", baked, "--resolution", resolution, "--quiet"});
    EXPECT_EQ(bake.exitCode, 0) << bake.err;
    const auto render = runPhat({"render", baked, "-o", picture, "--size", size, "--quiet"});
    EXPECT_EQ(render.exitCode, 0) << render.err;
    return readExr(picture);
}

// Albedo .5 and emission 1 nit all round: 2 nit everywhere.
TEST(Scenes, FurnaceIsTwoEverywhere) {
    const Image image = bakeAndRender("furnace.glb", "100k", "240x135");
    double sum = 0, low = 1e30, high = 0;
    for (const glm::vec3& pixel : image.pixels) {
        for (int c = 0; c < 3; ++c) {
            sum += double(pixel[c]) / (3.0 * double(image.pixels.size()));
            low = std::min(low, double(pixel[c]));
            high = std::max(high, double(pixel[c]));
        }
    }
    EXPECT_NEAR(sum, 2, 0.01);
    EXPECT_GT(low, 1.96);
    EXPECT_LT(high, 2.04);
}

// White materials in light of 1 nit from everywhere may lose light; they never gain any.
TEST(Scenes, GlossyFurnaceGainsNoLight) {
    const Image image = bakeAndRender("furnace-glossy.glb", "100k", "240x135");
    double sum = 0, high = 0;
    for (const glm::vec3& pixel : image.pixels) {
        sum += double(pixel.y) / double(image.pixels.size());
        high = std::max(high, double(maxComponent(pixel)));
    }
    EXPECT_LE(high, 1.005);
    EXPECT_GT(sum, 0.8);  // most of the picture is the wall itself
}

void expectReference(const std::string& scene, const std::string& reference, const std::string& resolution,
                     double maxError) {
    const Image want = readExr(PHAT_SOURCE_DIR "/tests/data/references/" + reference);
    const Image got =
        bakeAndRender(scene, resolution, std::to_string(want.width) + "x" + std::to_string(want.height));
    ASSERT_EQ(got.width, want.width);
    ASSERT_EQ(got.height, want.height);
    EXPECT_EQ(countNonFinite(got), 0u);
    const Metrics metrics = compareImages(got, want);
    EXPECT_NEAR(metrics.bias, 0, 0.02);
    EXPECT_LT(metrics.maeOverMean, maxError);
}

TEST(Scenes, TabletopMatchesItsReference) {
    expectReference("tabletop.glb", "tabletop-spec.exr", "500k", 0.06);
}

TEST(Scenes, CornellMatchesItsReference) {
    expectReference("cornell-glossy.glb", "cornell-glossy.exr", "100k", 0.045);
}

TEST(Scenes, GalleryMatchesItsReference) {
    expectReference("gallery.glb", "gallery-spec.exr", "300k", 0.105);
}

// A chrome sphere of roughness .1, too smooth for PHATexels: rays bring its error down to the reference's
// noise.
TEST(Scenes, GallerysChromeIsTraced) {
    const TemporaryFolder folder;
    const std::string baked = folder.file("scene.phat.glb"), picture = folder.file("picture.exr");
    const auto bake = runPhat(
        {"bake", PHAT_SOURCE_DIR "/scenes/gallery.glb", "-o", baked, "--resolution", "200k", "--quiet"});
    ASSERT_EQ(bake.exitCode, 0) << bake.err;
    const Image want = readExr(PHAT_SOURCE_DIR "/tests/data/references/gallery-spec.exr");
    const Image mask = readExr(PHAT_SOURCE_DIR "/tests/data/references/gallery.mask-chrome.exr");
    const auto metricsWith = [&](const char* reflections) {
        const auto render =
            runPhat({"render", baked, "-o", picture, "--reflections", reflections, "--size",
                     std::to_string(want.width) + "x" + std::to_string(want.height), "--quiet"});
        EXPECT_EQ(render.exitCode, 0) << render.err;
        return compareImages(readExr(picture), want, &mask);
    };
    const Metrics traced = metricsWith("auto"), lookedUp = metricsWith("lookup");
    EXPECT_NEAR(traced.bias, 0, 0.03);
    EXPECT_LT(traced.maeOverMean, 0.2);
    EXPECT_LT(traced.maeOverMean, 0.8 * lookedUp.maeOverMean);
}

}  // namespace
}  // namespace phat
