// phat render --animate as a child process.

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "support/run_program.h"

namespace phat {
namespace {

TEST(ConductAnimate, FramesAreTheSameOnAnyNumberOfThreads) {
    const TemporaryFolder folder;
    const std::string scene = PHAT_SOURCE_DIR "/scenes/tabletop-animated.glb",
                      baked = folder.file("small.phat.glb");
    ASSERT_EQ(
        runPhat({"bake", scene, "-o", baked, "--resolution", "4k", "--photons", "2k", "--quiet"}).exitCode,
        0);
    std::vector<std::vector<char>> frames[2];
    for (const int run : {0, 1}) {
        const std::string name = folder.file(run == 0 ? "one.exr" : "two.exr");
        const auto result = runPhat({"render", baked, "-o", name, "--animate", "1:1.5", "--fps", "4",
                                     "--work-per-frame", "200k", "--size", "48x32", "--spp", "1", "--threads",
                                     run == 0 ? "1" : "2", "--json", "--quiet"});
        ASSERT_EQ(result.exitCode, 0) << result.err;
        const auto report = nlohmann::json::parse(result.out);
        ASSERT_EQ(report.size(), 3u);
        EXPECT_EQ(report[0]["settled"], true);
        EXPECT_EQ(report[2]["animationSeconds"], 1.5);
        // A piece that takes more than a frame's share is made up for by the next frame.
        EXPECT_GT(report[1]["work"].get<int>() + report[2]["work"].get<int>(), 90'000);
        for (const auto& frame : report) frames[run].push_back(readBytes(frame["output"]));
    }
    EXPECT_EQ(frames[0], frames[1]);
    EXPECT_NE(frames[0][0], frames[0][2]);
}

TEST(ConductAnimate, RefusesWhatCannotBeAnimated) {
    const TemporaryFolder folder;
    const std::string still = PHAT_SOURCE_DIR "/scenes/cornell-glossy.glb",
                      baked = folder.file("still.phat.glb");
    ASSERT_EQ(
        runPhat({"bake", still, "-o", baked, "--resolution", "4k", "--photons", "2k", "--quiet"}).exitCode,
        0);
    const auto with = [&](std::vector<std::string> more) {
        std::vector<std::string> arguments = {"render", baked, "-o", folder.file("a.png"), "--quiet"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return runPhat(arguments).exitCode;
    };
    for (const char* times : {"5", "3:1", "0:1:2", "a:b", "0:1e9", "nan:1"})
        EXPECT_EQ(with({"--animate", times}), 2) << times;
    EXPECT_EQ(with({"--animate", "0:1"}), 2);  // has no animation
    EXPECT_EQ(with({"--fps", "3"}), 2);
    EXPECT_EQ(with({"--animate", "0:1", "--method", "path"}), 2);
    EXPECT_EQ(folder.fileCount(), 1u);
}

}  // namespace
}  // namespace phat
