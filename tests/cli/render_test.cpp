// phat render as a child process.

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "io/image/image_file.h"
#include "support/run_program.h"

namespace phat {
namespace {

const std::string kScene = PHAT_SOURCE_DIR "/scenes/tabletop.glb";

TEST(ConductRender, DrawsABakedFileAndRefusesWhatDoesNotExist) {
    const TemporaryFolder folder;
    const std::string baked = folder.file("small.phat.glb"), picture = folder.file("picture.exr");
    const auto bake =
        runPhat({"bake", kScene, "-o", baked, "--resolution", "4k", "--photons", "2k", "--quiet"});
    ASSERT_EQ(bake.exitCode, 0) << bake.err;

    const std::vector<std::string> render = {"render", baked, "-o", picture, "--size", "48x32", "--spp", "1"};
    const auto with = [&](std::vector<std::string> more) {
        std::vector<std::string> arguments = render;
        arguments.insert(arguments.end(), more.begin(), more.end());
        return runPhat(arguments);
    };
    for (const auto& wrong : std::vector<std::vector<std::string>>{{"--method", "magic"},
                                                                   {"--camera", "nobody"},
                                                                   {"--set", "nobody.roughness=1"},
                                                                   {"--set", "*.shininess=1"},
                                                                   {"--set", "*.roughness=2"},
                                                                   {"--eye", "1,2"},
                                                                   {"--component", "half"},
                                                                   {"--reflections", "some"},
                                                                   {"--follow", "--camera", "0"},
                                                                   {"--follow", "--animate", "0:1"}}) {
        const auto result = with(wrong);
        EXPECT_EQ(result.exitCode, 2) << wrong[1] << result.err;
        EXPECT_NE(result.err.find("phat: "), std::string::npos);
    }
    EXPECT_EQ(runPhat({"render", baked, "-o", folder.file("picture.bmp")}).exitCode, 2);
    EXPECT_EQ(folder.fileCount(), 1u);

    const auto result = with({"--json", "--quiet"});
    ASSERT_EQ(result.exitCode, 0) << result.err;
    EXPECT_EQ(nlohmann::json::parse(result.out)["width"], 48);
    const Image image = readExr(picture);
    EXPECT_EQ(image.width, 48);
    EXPECT_EQ(image.height, 32);
    double sum = 0;
    for (const glm::vec3& pixel : image.pixels) sum += luminance(pixel);
    EXPECT_GT(sum, 0);

    // A black table reflects less than a white one.
    const auto brightness = [&](const std::string& edit) {
        EXPECT_EQ(with({"--set", edit, "--quiet"}).exitCode, 0);
        double total = 0;
        for (const glm::vec3& pixel : readExr(picture).pixels) total += luminance(pixel);
        return total;
    };
    EXPECT_LT(brightness("*.baseColor=0"), 0.9 * brightness("*.baseColor=1,1,1"));

    const auto film = with({"--follow", "--camera", "all", "--json", "--quiet"});
    ASSERT_EQ(film.exitCode, 0) << film.err;
    EXPECT_GT(nlohmann::json::parse(film.out)["reflectionRays"], 0);
    EXPECT_TRUE(std::filesystem::exists(folder.file("picture.Camera.exr")));
}

}  // namespace
}  // namespace phat
