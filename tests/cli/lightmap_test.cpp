// phat export --lightmap, through the whole program.

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "io/gltf/gltf_source.h"
#include "support/run_program.h"
#include "support/temporary_folder.h"

namespace phat {
namespace {

struct LightmapCommand : testing::Test {
    LightmapCommand() {
        const auto result = runPhat({"bake", PHAT_SOURCE_DIR "/scenes/cornell-glossy.glb", "-o", baked,
                                     "--resolution", "30k", "--photons", "1k", "--quiet"});
        EXPECT_EQ(result.exitCode, 0) << result.err;
    }

    ProgramResult exported(const std::vector<std::string>& more) const {
        std::vector<std::string> arguments = {"export", baked, "--lightmap"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return runPhat(arguments);
    }
    // One line, and nothing in the folder.
    void expectRefused(const ProgramResult& result, const std::string& reason) const {
        EXPECT_EQ(result.exitCode, 1);
        EXPECT_EQ(result.err.rfind("phat: ", 0), 0u) << result.err;
        EXPECT_NE(result.err.find(reason), std::string::npos) << result.err;
        EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    }
    bool exists(const std::string& name) const { return std::filesystem::exists(folder.file(name)); }

    TemporaryFolder folder;
    std::string baked = folder.file("room.phat.glb"), target = folder.file("lightmap");
};

TEST_F(LightmapCommand, WritesWhatItSays) {
    const auto result = exported({target});
    ASSERT_EQ(result.exitCode, 0) << result.err;
    for (const char* name : {"room.glb", "lightmap-0.exr", "lightmap-0.png", "lightmap.json"}) {
        const std::string path = target + "/" + name;
        EXPECT_NE(
            result.out.find(path + ": " + std::to_string(std::filesystem::file_size(path)) + " bytes\n"),
            std::string::npos)
            << result.out;
    }
    const auto text = readBytes(target + "/lightmap.json");
    const auto description = nlohmann::json::parse(text.begin(), text.end());
    EXPECT_EQ(description["light"], "area");
    EXPECT_EQ(description["scene"], "room.glb");
    EXPECT_EQ(openGltf(target + "/room.glb").json.dump().find("PHAT_"), std::string::npos);
    EXPECT_EQ(exported({target, "--quiet"}).out, "");
}

TEST_F(LightmapCommand, AnOlderLightmapIsReplaced) {
    ASSERT_EQ(exported({target, "--page-size", "104"}).exitCode, 0);
    ASSERT_TRUE(exists("lightmap/lightmap-1.exr"));
    writeBytes(target + "/mine.txt", {'m'});
    ASSERT_EQ(exported({target, "--light", "indirect"}).exitCode, 0);
    EXPECT_FALSE(exists("lightmap/lightmap-1.exr"));
    EXPECT_TRUE(exists("lightmap/lightmap-0.exr"));
    EXPECT_TRUE(exists("lightmap/mine.txt"));
}

TEST_F(LightmapCommand, RefusesWithoutATrace) {
    expectRefused(exported({target, "--page-size", "16"}), "room.phat.glb: pages of 16 texels are too small");
    EXPECT_FALSE(exists("lightmap"));
    std::filesystem::create_directory(target);
    writeBytes(target + "/mine.txt", {'m'});
    expectRefused(exported({target}), "has files in it that are not of a lightmap");
    expectRefused(exported({target + "/mine.txt"}), "is not a folder");
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(target), {}), 1);
    const std::string scene = PHAT_SOURCE_DIR "/scenes/cornell-glossy.glb";
    expectRefused(runPhat({"export", scene, "--lightmap", folder.file("other")}), "is not a baked file");
    EXPECT_FALSE(exists("other"));
}

TEST_F(LightmapCommand, FlagsOfALightmapNeedOne) {
    EXPECT_EQ(runPhat({"export", baked}).exitCode, 2);
    EXPECT_EQ(runPhat({"export", baked, "--exr", target, "--light", "all"}).exitCode, 2);
    EXPECT_EQ(exported({target, "--light", "glossy"}).exitCode, 2);
    EXPECT_EQ(exported({target, "--page-size", "1"}).exitCode, 2);
    EXPECT_FALSE(exists("lightmap"));
}

}  // namespace
}  // namespace phat
