// phat bake --probes and phat render --with, as child processes.

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "io/gltf/gltf_builder.h"
#include "io/image/image_file.h"
#include "support/run_program.h"

namespace phat {
namespace {

const std::string kScene = PHAT_SOURCE_DIR "/scenes/tabletop.glb";

/// A white triangle before tabletop's camera.
std::string writeThing(const TemporaryFolder& folder) {
    test::GltfBuilder gltf;
    const int positions = gltf.floats("VEC3", {-0.2f, 0.9f, 1, 0.5f, 0.9f, 1, 0.1f, 1.5f, 1});
    gltf.json["accessors"][0]["min"] = {-0.2f, 0.9f, 1};
    gltf.json["accessors"][0]["max"] = {0.5f, 1.5f, 1};
    gltf.root({{"mesh", gltf.mesh({{"attributes", {{"POSITION", positions}}}})}});
    const std::string path = folder.file("thing.glb");
    writeBytes(path, gltf.glb());
    return path;
}

double brightness(const std::string& picture) {
    double sum = 0;
    for (const glm::vec3& pixel : readExr(picture).pixels) sum += luminance(pixel);
    return sum;
}

TEST(ConductThings, AreLitByTheProbesOfTheFile) {
    const TemporaryFolder folder;
    const std::string thing = writeThing(folder);
    const auto bake = [&](const std::string& name, const std::vector<std::string>& more) {
        std::vector<std::string> arguments = {"bake", kScene,      "-o", folder.file(name), "--resolution",
                                              "4k",   "--photons", "2k", "--quiet"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return runPhat(arguments);
    };
    EXPECT_EQ(bake("x.phat.glb", {"--probes", "3"}).exitCode, 2);
    EXPECT_EQ(bake("x.phat.glb", {"--probes", "many"}).exitCode, 2);
    ASSERT_EQ(bake("with.phat.glb", {"--probes", "64"}).exitCode, 0);
    ASSERT_EQ(bake("without.phat.glb", {"--probes", "none"}).exitCode, 0);
    const auto info = [&](const std::string& name) {
        return nlohmann::json::parse(runPhat({"info", folder.file(name), "--json"}).out)["bake"]["probes"];
    };
    EXPECT_GT(info("with.phat.glb")["count"].get<int>(), 32);
    EXPECT_LE(info("with.phat.glb")["count"].get<int>(), 64);
    EXPECT_EQ(info("without.phat.glb")["count"].get<int>(), 0);
    const auto text = runPhat({"info", folder.file("with.phat.glb")}).out;
    EXPECT_NE(text.find("probes"), std::string::npos);

    const std::string picture = folder.file("picture.exr");
    const auto draw = [&](const std::string& file, const std::vector<std::string>& more) {
        std::vector<std::string> arguments = {"render", folder.file(file), "-o", picture,         "--size",
                                              "48x32",  "--spp",           "1",  "--reflections", "lookup"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return runPhat(arguments);
    };
    ASSERT_EQ(draw("with.phat.glb", {}).exitCode, 0);
    const double empty = brightness(picture);
    ASSERT_EQ(draw("with.phat.glb", {"--with", thing}).exitCode, 0);
    const double stored = brightness(picture);
    EXPECT_GT(std::abs(stored - empty), 0.01 * empty);
    // A file without probes gets them for the picture, with a line that says so.
    const auto made = draw("without.phat.glb", {"--with", thing});
    ASSERT_EQ(made.exitCode, 0);
    EXPECT_NE(made.err.find("has no light probes"), std::string::npos) << made.err;
    EXPECT_NEAR(brightness(picture), stored, 0.05 * stored);
    // Twice the same thing is the same picture, but for its contact shadow: those of several things multiply.
    ASSERT_EQ(draw("with.phat.glb", {"--with", thing, "--with", thing}).exitCode, 0);
    EXPECT_LE(brightness(picture), stored);
    EXPECT_GT(brightness(picture), 0.99 * stored);

    EXPECT_EQ(draw("with.phat.glb", {"--with", folder.file("nothing.glb")}).exitCode, 1);
    EXPECT_EQ(draw("with.phat.glb", {"--with", thing, "--method", "path"}).exitCode, 2);
    EXPECT_EQ(draw("with.phat.glb", {"--with", thing, "--refine", "1"}).exitCode, 2);
}

}  // namespace
}  // namespace phat
