// phat render --method path as a child process.

#include <gtest/gtest.h>

#include <chrono>
#include <nlohmann/json.hpp>

#include "core/base/stopwatch.h"
#include "io/image/image_file.h"
#include "support/run_program.h"

namespace phat {
namespace {

const std::string kScene = PHAT_SOURCE_DIR "/scenes/cornell-glossy.glb";

ProgramResult trace(const std::string& output, std::vector<std::string> more,
                    const std::string& scene = kScene) {
    std::vector<std::string> arguments = {"render", scene,    "-o",    output,   "--method",
                                          "path",   "--size", "24x16", "--quiet"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return runPhat(arguments);
}

double meanOf(const std::string& path) {
    const Image image = readExr(path);
    double sum = 0;
    for (const glm::vec3& pixel : image.pixels) sum += double(luminance(pixel));
    return sum / double(image.pixels.size());
}

TEST(ConductPath, SameBytesForAnyNumberOfThreadsAndOtherSeedsDiffer) {
    const TemporaryFolder folder;
    std::vector<std::string> pictures, variances;
    for (const char* threads : {"1", "2", "8"}) {
        pictures.push_back(folder.file(std::string(threads) + ".exr"));
        variances.push_back(folder.file(std::string(threads) + ".variance.exr"));
        const auto result =
            trace(pictures.back(), {"--spp", "20", "--threads", threads, "--variance", variances.back()});
        ASSERT_EQ(result.exitCode, 0) << result.err;
        EXPECT_EQ(readBytes(pictures.back()), readBytes(pictures.front()));
        EXPECT_EQ(readBytes(variances.back()), readBytes(variances.front()));
    }
    EXPECT_GT(meanOf(variances.front()), 0);
    EXPECT_EQ(trace(folder.file("other.exr"), {"--spp", "20", "--seed", "2"}).exitCode, 0);
    EXPECT_NE(readBytes(folder.file("other.exr")), readBytes(pictures.front()));
}

TEST(ConductPath, ReportsAndKeepsToTheTime) {
    const TemporaryFolder folder;
    const auto result = trace(folder.file("a.exr"), {"--time", "0.3", "--json"});
    ASSERT_EQ(result.exitCode, 0) << result.err;
    const auto report = nlohmann::json::parse(result.out);
    EXPECT_EQ(report["method"], "path");
    EXPECT_GT(report["samplesPerPixel"], 1);
    EXPECT_GE(report["seconds"].get<double>(), 0.3);
    EXPECT_GT(report["raysPerSecond"].get<double>(), 0);

    const auto byDefault = trace(folder.file("a.exr"), {"--json"});
    EXPECT_EQ(nlohmann::json::parse(byDefault.out)["samplesPerPixel"], 64);
}

TEST(ConductPath, ABakedFileGivesThePictureOfItsScene) {
    const TemporaryFolder folder;
    const std::string baked = folder.file("baked.phat.glb");
    const auto bake =
        runPhat({"bake", kScene, "-o", baked, "--resolution", "4k", "--photons", "2k", "--quiet"});
    ASSERT_EQ(bake.exitCode, 0) << bake.err;
    ASSERT_EQ(trace(folder.file("scene.exr"), {"--spp", "16"}).exitCode, 0);
    ASSERT_EQ(trace(folder.file("baked.exr"), {"--spp", "16"}, baked).exitCode, 0);
    const Image scene = readExr(folder.file("scene.exr")), again = readExr(folder.file("baked.exr"));
    // Its vertices are split along the charts: the same light, not necessarily the same random numbers.
    EXPECT_NEAR(meanOf(folder.file("baked.exr")) / meanOf(folder.file("scene.exr")), 1, 0.1);
    EXPECT_EQ(scene.pixels.size(), again.pixels.size());
}

TEST(ConductPath, AllCamerasEnvironmentAndEdits) {
    const TemporaryFolder folder;
    ASSERT_EQ(trace(folder.file("room.exr"), {"--camera", "all", "--spp", "2"}).exitCode, 0);
    EXPECT_TRUE(std::filesystem::exists(folder.file("room.Camera.exr")));
    EXPECT_EQ(folder.fileCount(), 1u);

    const std::string sky = folder.file("sky.exr"), dark = folder.file("dark.exr"),
                      lit = folder.file("lit.exr");
    writeExr(sky, Image(8, 4, glm::vec3(1)));
    const std::vector<std::string> away = {"--eye", "0,0,50", "--target", "0,0,100", "--spp", "2"};
    ASSERT_EQ(trace(dark, away).exitCode, 0);
    EXPECT_EQ(meanOf(dark), 0);
    std::vector<std::string> withSky = away;
    withSky.insert(withSky.end(), {"--environment", sky});
    ASSERT_EQ(trace(lit, withSky).exitCode, 0);
    EXPECT_NEAR(meanOf(lit), 1, 1e-5);
}

TEST(ConductPath, WrongCombinationsAreOneLineAndLeaveNothing) {
    const TemporaryFolder folder;
    const std::string out = folder.file("a.exr");
    for (const auto& wrong : std::vector<std::vector<std::string>>{{"--spp", "4", "--time", "1"},
                                                                   {"--spp", "0"},
                                                                   {"--time", "-1"},
                                                                   {"--variance", folder.file("v.png")},
                                                                   {"--variance", out},
                                                                   {"--pixel-filter", "cone"},
                                                                   {"--camera", "nobody"}}) {
        const auto result = trace(out, wrong);
        EXPECT_EQ(result.exitCode, 2) << wrong[0] << result.err;
        EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    }
    for (const auto& traced : std::vector<std::vector<std::string>>{
             {"--variance", folder.file("v.exr")}, {"--time", "1"}, {"--seed", "3"}, {"--pixels", "m.exr"}}) {
        std::vector<std::string> arguments = {"render", kScene, "-o", out, "--method", "phat"};
        arguments.insert(arguments.end(), traced.begin(), traced.end());
        const auto result = runPhat(arguments);
        EXPECT_EQ(result.exitCode, 2) << traced[0];
        EXPECT_NE(result.err.find(traced[0] + ": --method phat is drawn, not traced"), std::string::npos)
            << result.err;
    }
    const auto drawn = runPhat({"render", kScene, "-o", out, "--keep-light"});
    EXPECT_EQ(drawn.exitCode, 2);
    EXPECT_NE(drawn.err.find("--keep-light: means nothing to --method phat"), std::string::npos) << drawn.err;
    EXPECT_EQ(trace(folder.file("none/a.exr"), {}).exitCode, 1);
    EXPECT_EQ(folder.fileCount(), 0u);
}

TEST(ConductPath, PixelsOfAMask) {
    const TemporaryFolder folder;
    const std::string mask = folder.file("mask.exr"), out = folder.file("a.exr");
    Image kept(24, 16);
    kept.at(10, 9) = kept.at(14, 6) = glm::vec3(1);
    writeExr(mask, kept);
    ASSERT_EQ(trace(out, {"--spp", "64", "--pixels", mask}).exitCode, 0);
    const Image picture = readExr(out);
    for (int y = 0; y < 16; ++y)
        for (int x = 0; x < 24; ++x) EXPECT_EQ(luminance(picture.at(x, y)) > 0, kept.at(x, y).x > 0);

    std::filesystem::remove(out);
    for (const auto& [wrong, reason] :
         {std::pair(Image(24, 15, glm::vec3(1)), "is 24 x 15 pixels, the picture 24 x 16"),
          std::pair(Image(24, 16), "keeps no pixel")}) {
        writeExr(mask, wrong);
        const auto result = trace(out, {"--pixels", mask});
        EXPECT_EQ(result.exitCode, 1);
        EXPECT_NE(result.err.find(reason), std::string::npos) << result.err;
        EXPECT_FALSE(std::filesystem::exists(out));
    }
}

// What a bake shows of a changed material: its own look, but not its light on others.
TEST(ConductPath, EditsForTheEyeAlone) {
    const TemporaryFolder folder;
    const auto mean = [&](std::vector<std::string> more) {
        more.insert(more.end(), {"--spp", "64", "--component", "indirect"});
        EXPECT_EQ(trace(folder.file("a.exr"), more).exitCode, 0);
        return meanOf(folder.file("a.exr"));
    };
    const double plain = mean({}), all = mean({"--set", "*.baseColor=0,0,0"}),
                 eye = mean({"--set", "*.baseColor=0.1,0.1,0.1", "--keep-light"});
    EXPECT_LT(all, 0.1 * plain);
    EXPECT_GT(eye, 0.1 * plain);
    EXPECT_LT(eye, 0.4 * plain);
}

TEST(ConductPath, StopsSoonAndLeavesNothing) {
    const TemporaryFolder folder;
    const Stopwatch start;
    const std::string line = "timeout --preserve-status -s INT 0.5 '" PHAT_PROGRAM "' render '" + kScene +
                             "' -o '" + folder.file("a.exr") +
                             "' --method path --spp 65536 --quiet 2>/dev/null";
    const int status = std::system(line.c_str());
    EXPECT_EQ(WEXITSTATUS(status), 130);
    EXPECT_LT(start.seconds(), 60);  // all samples would take more than ten minutes
    EXPECT_EQ(folder.fileCount(), 0u);
}

}  // namespace
}  // namespace phat
