// phat bench as a child process.

#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "gl/renderer.h"
#include "support/run_program.h"

namespace phat {
namespace {

using nlohmann::json;

// With a lamp at a point, which has shadow maps.
const std::string kScene = PHAT_SOURCE_DIR "/scenes/gallery.glb";

void expectTimes(const json& report) {
    double sum = 0;
    for (const auto& entry : report["passMilliseconds"].items()) {
        const std::string& pass = entry.key();
        const double milliseconds = entry.value();
        EXPECT_TRUE(std::any_of(kGpuPasses.begin(), kGpuPasses.end(), [&](const NamedPass& known) {
            return known.name == pass;
        })) << pass;
        EXPECT_GT(milliseconds, 0) << pass;
        sum += milliseconds;
    }
    for (const char* pass : {"depth", "lobes", "rayGuides", "rayTrace", "rayShade", "rayPool", "display"})
        EXPECT_TRUE(report["passMilliseconds"].contains(pass)) << pass;
    EXPECT_FALSE(report["passMilliseconds"].contains("shadows")) << "the warm-up is not measured";
    // Medians of parts and of their sum; the machine may be busy during one of them.
    EXPECT_GT(report["gpuMilliseconds"].get<double>(), 0.2 * sum);
    EXPECT_GT(report["frameMilliseconds"].get<double>(), 0.2 * sum);
}

TEST(Bench, MeasuresTheRenderersPassesOfABakedFile) {
    const TemporaryFolder folder;
    const std::string baked = folder.file("small.phat.glb");
    ASSERT_EQ(
        runPhat({"bake", kScene, "-o", baked, "--resolution", "4k", "--photons", "2k", "--quiet"}).exitCode,
        0);
    std::vector<double> lookups;
    for (const char* quality : {"fast", "high"}) {
        const ProgramResult result =
            runPhat({"bench", baked, "--size", "64x36", "--frames", "3", "--quality", quality});
        ASSERT_EQ(result.exitCode, 0) << result.err;
        const json report = json::parse(result.out);
        expectTimes(report);
        EXPECT_EQ(report["width"], 64);
        EXPECT_EQ(report["height"], 36);
        EXPECT_EQ(report["frames"], 3);
        EXPECT_EQ(report["quality"], quality);
        EXPECT_EQ(report["scene"], "small.phat.glb");
        for (const char* name : {"gpu", "driver"}) EXPECT_FALSE(report[name].get<std::string>().empty());
        EXPECT_FALSE(report["passMilliseconds"].contains("lookup")) << "rays need none";
        EXPECT_GT(report["fetchesPerPixel"].get<double>(), 20 * report["raysPerPixel"].get<double>());
        EXPECT_GT(report["raysPerPixel"].get<double>(), 0.1);
        EXPECT_LT(report["raysPerPixel"].get<double>(), 8);
        lookups.push_back(report["reads"]["indirect"]["mean"]);
        EXPECT_GT(report["reads"]["area"]["mean"], 0);
    }
    // 2 samples a pixel and 32.
    EXPECT_GT(lookups[1], 4 * lookups[0]);
    const ProgramResult lookedUp =
        runPhat({"bench", baked, "--size", "64x36", "--frames", "1", "--reflections", "lookup", "--quiet"});
    const json ofLookup = json::parse(lookedUp.out);
    for (const char* pass : {"lobes", "lookup", "pool"})
        EXPECT_TRUE(ofLookup["passMilliseconds"].contains(pass)) << lookedUp.err;
    for (const char* part : {"rayGuides", "rayTrace", "rayShade", "rayLights", "rayPool"})
        EXPECT_FALSE(ofLookup["passMilliseconds"].contains(part)) << part;
    for (const char* figure : {"raysPerPixel", "fetchesPerPixel"}) EXPECT_FALSE(ofLookup.contains(figure));
    const ProgramResult table =
        runPhat({"bench", baked, "--size", "64x36", "--frames", "1", "--table", "--quiet"});
    for (const char* words : {"GPU", "  rayTrace", "all passes", " ms\n", "64 x 36, quality default",
                              "of area light", "million a second", "fetches a pixel"})
        EXPECT_NE(table.out.find(words), std::string::npos) << words << '\n' << table.out;
    EXPECT_EQ(table.err, "");
}

// Where directions follow no invertible layout nothing is looked up. The paper's passes run whenever the eye
// has moved.
TEST(Bench, MeasuresThePapersPassesWithTheEyeInMotion) {
    const TemporaryFolder folder;
    const std::string baked = folder.file("photons.phat.glb");
    ASSERT_EQ(runPhat({"bake", PHAT_SOURCE_DIR "/scenes/cornell-glossy.glb", "-o", baked, "--directions",
                       "photons", "--resolution", "4k", "--photons", "2k", "--quiet"})
                  .exitCode,
              0);
    for (const char* frames : {"1", "3"}) {
        const ProgramResult result =
            runPhat({"bench", baked, "--size", "32x32", "--frames", frames, "--quiet"});
        ASSERT_EQ(result.exitCode, 0) << result.err;
        const json report = json::parse(result.out);
        for (const char* pass : {"relight", "pyramid", "display"})
            EXPECT_GT(report["passMilliseconds"].value(pass, 0.0), 0) << pass << ' ' << result.out;
        EXPECT_FALSE(report["passMilliseconds"].contains("lookup"));
        EXPECT_FALSE(report.contains("reads"));
    }
}

TEST(Bench, HasASceneOfItsOwn) {
    const ProgramResult result = runPhat({"bench", "--size", "32x18", "--frames", "1", "--quiet"});
    ASSERT_EQ(result.exitCode, 0) << result.err;
    const json report = json::parse(result.out);
    expectTimes(report);
    EXPECT_EQ(report["scene"], "tabletop.glb");
    EXPECT_NEAR(report["texels"].get<double>(), 1 << 20, 0.1 * (1 << 20));
}

TEST(Bench, SaysInOneLineWhatIsWrong) {
    const TemporaryFolder folder;
    const std::string broken = folder.file("broken.glb");
    writeBytes(broken, {'g', 'l', 'T', 'F', 2, 0});
    for (const std::string& input : {folder.file("missing.glb"), broken}) {
        const ProgramResult result = runPhat({"bench", input});
        EXPECT_EQ(result.exitCode, 1);
        EXPECT_EQ(result.out, "");
        EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
        EXPECT_EQ(result.err.rfind("phat: " + input + ": ", 0), 0u) << result.err;
    }
    for (const std::vector<std::string>& wrong :
         std::vector<std::vector<std::string>>{{"--size", "64"},
                                               {"--size", "0x9"},
                                               {"--frames", "0"},
                                               {"--frames", "x"},
                                               {"--quality", "best"}}) {
        const ProgramResult result = runPhat({"bench", kScene, wrong[0], wrong[1]});
        EXPECT_EQ(result.exitCode, 2) << wrong[0] << ' ' << wrong[1];
        EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    }
}

}  // namespace
}  // namespace phat
