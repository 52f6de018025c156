// phat render --refine as a child process.

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "support/run_program.h"

namespace phat {
namespace {

TEST(ConductRefine, MakesTheSamePictureOnAnyNumberOfThreads) {
    const TemporaryFolder folder;
    const std::string baked = folder.file("small.phat.glb");
    ASSERT_EQ(runPhat({"bake", PHAT_SOURCE_DIR "/scenes/cornell-glossy.glb", "-o", baked, "--resolution",
                       "4k", "--photons", "2k", "--quiet"})
                  .exitCode,
              0);
    const auto picture = [&](const char* name, const char* threads, const char* passes) {
        const std::string out = folder.file(name);
        const auto result = runPhat({"render", baked, "-o", out, "--refine", passes, "--size", "48x48",
                                     "--spp", "2", "--threads", threads, "--json", "--quiet"});
        EXPECT_EQ(result.exitCode, 0) << result.err;
        EXPECT_EQ(nlohmann::json::parse(result.out)["refinements"], std::atoi(passes));
        return readBytes(out);
    };
    const auto one = picture("one.exr", "1", "2");
    EXPECT_EQ(one, picture("two.exr", "2", "2"));
    EXPECT_NE(one, picture("three.exr", "2", "1"));

    for (const std::vector<std::string>& more :
         {std::vector<std::string>{"--method", "path"}, {"--set", "*.roughness=.3"}, {"--animate", "0:1"}}) {
        std::vector<std::string> words = {"render",   baked, "-o",     folder.file("a.png"),
                                          "--refine", "1",   "--quiet"};
        words.insert(words.end(), more.begin(), more.end());
        EXPECT_EQ(runPhat(words).exitCode, 2) << more[0];
    }
    EXPECT_EQ(folder.fileCount(), 4u);
}

}  // namespace
}  // namespace phat
