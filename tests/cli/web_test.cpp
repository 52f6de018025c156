// phat web and the size of what it sends, through the whole program.

#include <gtest/gtest.h>

#include <filesystem>

#include "support/run_program.h"
#include "support/temporary_folder.h"

namespace phat {
namespace {

const std::string kScene = PHAT_SOURCE_DIR "/scenes/cornell-glossy.glb";

TEST(WebFiles, MaxMegabytesIsKept) {
    const TemporaryFolder folder;
    const std::string out = folder.file("room.phat.glb");
    for (const double megabytes : {0.2, 0.6}) {
        const auto result = runPhat({"bake", kScene, "-o", out, "--max-megabytes", std::to_string(megabytes),
                                     "--photons", "20k", "--paths", "1", "--quiet"});
        ASSERT_EQ(result.exitCode, 0) << result.err;
        const double size = double(std::filesystem::file_size(out)) * 1e-6;
        EXPECT_LE(size, megabytes);
        EXPECT_GE(size, 0.5 * megabytes);
    }
    const auto written = std::filesystem::last_write_time(out);
    const auto tooSmall =
        runPhat({"bake", kScene, "-o", out, "--max-megabytes", "0.0101", "--photons", "1k"});
    EXPECT_EQ(tooSmall.exitCode, 1);
    EXPECT_NE(tooSmall.err.find("--max-megabytes"), std::string::npos) << tooSmall.err;
    EXPECT_EQ(std::filesystem::last_write_time(out), written);
    EXPECT_EQ(folder.fileCount(), 1u);
}

TEST(WebFiles, APageNeedsABake) {
    const TemporaryFolder folder;
    const auto result = runPhat({"web", kScene, "-o", folder.file("site")});
    EXPECT_EQ(result.exitCode, 1);
    EXPECT_EQ(result.err, "phat: " + kScene + ": is not a baked file: `phat bake` makes one\n");
    EXPECT_EQ(folder.fileCount(), 0u);
}

}  // namespace
}  // namespace phat
