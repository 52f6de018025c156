// Small files that aim at memory, time, the stack or the terminal (tests/data/hostile).

#include <gtest/gtest.h>
#include <zlib.h>

#include <algorithm>

#include "support/run_limited.h"

namespace phat {
namespace {

constexpr Limits kLimits{.processorSeconds = 10, .megabytes = 500, .clockSeconds = 600};

class ConductHostile : public testing::Test {
  protected:
    // The uncompressed file.
    std::string given(const std::string& name) const {
        const std::string packed = std::string(PHAT_SOURCE_DIR) + "/tests/data/hostile/" + name + ".gz";
        const std::string path = folder.file(name);
        std::ofstream plain(path, std::ios::binary);
        gzFile_s* in = gzopen(packed.c_str(), "rb");
        std::vector<char> part(1 << 16);
        for (int got; in && (got = gzread(in, part.data(), unsigned(part.size()))) > 0;)
            plain.write(part.data(), got);
        if (in) gzclose(in);
        return path;
    }
    std::string output(const std::string& name) const { return folder.file(name); }

    // One line that names `file` and gives `reason`, exit code 1, and nothing written.
    void expectRefused(const std::vector<std::string>& arguments, const std::string& file,
                       const std::string& reason) {
        const size_t before = folder.fileCount();
        const auto result = runLimited(arguments, kLimits);
        EXPECT_EQ(result.exitCode, 1) << result.err;
        EXPECT_TRUE(result.err.starts_with("phat: " + file + ": ")) << result.err;
        EXPECT_NE(result.err.find(reason), std::string::npos) << result.err;
        EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
        EXPECT_EQ(folder.fileCount(), before);
    }

    TemporaryFolder folder;
};

TEST_F(ConductHostile, PhatexelWithoutAChart) {
    const std::string file = given("orphan-export.phat.glb");
    expectRefused({"export", file, "--exr", output("exr")}, file,
                  "a PHATexel lies on a tile that has no chart");
}

TEST_F(ConductHostile, SettingsNestedDeeply) {
    const std::string file = given("settings200k.phat.glb");
    for (const auto& arguments : {std::vector<std::string>{"info", file}, {"info", file, "--json"}}) {
        const auto result = runLimited(arguments, kLimits);
        EXPECT_EQ(result.exitCode, 0) << result.err;
        EXPECT_LT(result.out.size(), 10'000u);
    }
}

TEST_F(ConductHostile, AtlasOutOfProportion) {
    const std::string file = given("size8192.phat.glb");
    expectRefused({"info", file}, file, "out of proportion to the file's size");
}

TEST_F(ConductHostile, ChartsThatOverlap) {
    const std::string file = given("charts100.phat.glb");
    expectRefused({"info", file}, file, "charts overlap");
}

TEST_F(ConductHostile, ViewsThatOverlap) {
    const std::string file = given("overlapping-views.phat.glb");
    expectRefused({"web", file, "-o", output("site"), "--quiet"}, file,
                  "too many of its bufferViews overlap");
}

TEST_F(ConductHostile, PictureWithMoreDataThanPixels) {
    const std::string file = given("png-8x8-600mb.png");
    expectRefused({"compare", file, file}, file, "the picture is broken");
}

TEST_F(ConductHostile, SkyWithoutData) {
    const std::string file = given("dwa-min.exr"),
                      scene = std::string(PHAT_SOURCE_DIR) + "/scenes/cornell-glossy.glb";
    expectRefused(
        {"bake", scene, "-o", output("x.phat.glb"), "--environment", file, "--resolution", "5k", "--quiet"},
        file, "the file is too short for 11584 x 11584 pixels");
}

TEST_F(ConductHostile, NamesThatSpeakToTheTerminal) {
    const auto result = runLimited({"info", given("escapes.phat.glb")}, kLimits);
    EXPECT_EQ(result.exitCode, 0) << result.err;
    for (const std::string& text : {result.out, result.err})
        for (const char c : text) EXPECT_TRUE(c == '\n' || (unsigned(c) >= 0x20 && c != 0x7f)) << int(c);
    EXPECT_NE(result.out.find("PWNED"), std::string::npos) << result.out;
}

}  // namespace
}  // namespace phat
