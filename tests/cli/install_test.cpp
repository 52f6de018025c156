// The program and the core library as `cmake --install` puts them somewhere.

#include <gtest/gtest.h>

#include <cstdio>

#include "support/run_program.h"

namespace phat {
namespace {

namespace fs = std::filesystem;

class Installed : public testing::Test {
  protected:
    // Somewhere else than where it was installed: packages are unpacked anywhere.
    static void SetUpTestSuite() {
        folder = new TemporaryFolder;
        const std::string first = folder->file("first");
        const auto result = runProgram("cmake", {"--install", PHAT_BINARY_DIR, "--prefix", first});
        ASSERT_EQ(result.exitCode, 0) << result.err;
        fs::rename(first, prefix());
    }
    static void TearDownTestSuite() { delete folder; }

    static fs::path prefix() { return folder->path / "moved"; }
    static ProgramResult run(const std::vector<std::string>& arguments) {
        return runProgram(prefix() / "bin/phat", arguments);
    }

    static inline TemporaryFolder* folder = nullptr;
};

TEST_F(Installed, ProgramHasItsDataBesideIt) {
    EXPECT_EQ(run({"--version"}).exitCode, 0);
    const std::string baked = folder->file("room.phat.glb"), picture = folder->file("room.png");
    const auto bake = run({"bake", prefix() / "share/phatextures/scenes/tabletop.glb", "-o", baked, "--quiet",
                           "--resolution", "5k", "--photons", "10k"});
    ASSERT_EQ(bake.exitCode, 0) << bake.err;
    const std::vector<std::string> render{"render", baked, "-o", picture, "--size", "32x18", "--quiet"};
    const auto drawn = run(render);
    EXPECT_EQ(drawn.exitCode, 0) << drawn.err;
    EXPECT_TRUE(fs::exists(picture));

    // Those shaders, and not the ones that it was built with.
    const fs::path shader = prefix() / "share/phatextures/shaders/display.frag";
    ASSERT_TRUE(fs::remove(shader));
    const auto without = run(render);
    EXPECT_EQ(without.exitCode, 1);
    EXPECT_NE(without.err.find(shader), std::string::npos) << without.err;
}

TEST_F(Installed, LibraryServesOtherProjects) {
    const fs::path source = prefix() / "share/doc/libphatextures-dev/examples/furnace";
    const std::string build = folder->file("furnace");
    const auto configured =
        runProgram("cmake", {"-S", source, "-B", build, "-DCMAKE_PREFIX_PATH=" + prefix().string()});
    ASSERT_EQ(configured.exitCode, 0) << configured.err;
    const auto built = runProgram("cmake", {"--build", build});
    ASSERT_EQ(built.exitCode, 0) << built.out << built.err;
    const auto result = runProgram(build + "/furnace", {});
    ASSERT_EQ(result.exitCode, 0) << result.err;
    double fromWalls = 0, reflected = 0;
    ASSERT_EQ(
        std::sscanf(result.out.c_str(), "from the walls %lf, after reflections %lf", &fromWalls, &reflected),
        2)
        << result.out;
    EXPECT_NEAR(fromWalls, 1, 0.01);
    EXPECT_NEAR(reflected, 1, 0.01);
}

}  // namespace
}  // namespace phat
