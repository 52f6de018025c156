// The viewer as a user has it: a window, a mouse, keys.

#include <gtest/gtest.h>

#include <algorithm>

#include "core/metrics.h"
#include "io/baked_file.h"
#include "io/image_file.h"
#include "run_program.h"

namespace phat {
namespace {

const std::string kScene = PHAT_SOURCE_DIR "/scenes/tabletop.glb";

struct ViewerWindow : testing::Test {
    void SetUp() override {
        const auto result =
            runPhat({"bake", kScene, "-o", baked, "--resolution", "16k", "--photons", "20k", "--quiet"});
        ASSERT_EQ(result.exitCode, 0) << result.err;
    }
    void drive(const std::string& steps) {
        const std::string file = folder.file("steps");
        writeBytes(file, {steps.begin(), steps.end()});
        const std::string line = "'" PHAT_SOURCE_DIR "/tests/viewer/drive.sh' '" PHAT_PROGRAM "' '" + baked + "' '" +
                                 folder.path.string() + "' <'" + file + "'";
        ASSERT_EQ(std::system(line.c_str()), 0);
    }
    Image kept(const char* number) { return readExr(folder.file(std::string("phat-") + number + ".exr")); }
    Image rendered(std::vector<std::string> more) {
        const std::string out = folder.file("rendered.exr");
        std::vector<std::string> arguments = {"render", baked, "-o", out, "--size", "370x400", "--spp", "16", "--quiet"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        const auto result = runPhat(arguments);
        EXPECT_EQ(result.exitCode, 0) << result.err;
        return readExr(out);
    }
    TemporaryFolder folder;
    const std::string baked = folder.file("room.phat.glb");
};

// Only the order in which 16 samples are added may differ.
void expectEqual(const Image& a, const Image& b) {
    ASSERT_EQ(a.width, b.width);
    ASSERT_EQ(a.height, b.height);
    EXPECT_LT(compareImages(a, b).maeOverMean, 1e-5);
}

TEST_F(ViewerWindow, ShowsMovesEditsAndSaves) {
    // The crate is left of the picture's middle; its roughness is the first slider below its name.
    drive(R"(keep 0001
drag 520 300 600 320
keep 0002
key Home
click 460 160
ctrl-click 110 218
type 0.25
keep 0003
ctrl-key z
keep 0004
ctrl-key y
ctrl-key s
key c
keep 0005
)");
    const Image start = kept("0001");
    expectEqual(start, rendered({}));
    EXPECT_GT(compareImages(kept("0002"), start).maeOverMean, 0.05);
    const Image edited = kept("0003");
    EXPECT_GT(compareImages(edited, start).maeOverMean, 1e-4);
    expectEqual(edited, rendered({"--set", "crate.roughness=0.25"}));  // saved with .25, which changes nothing
    expectEqual(kept("0004"), start);
    const std::vector<Material> materials = readBakedFile(baked).loaded.scene.materials;
    const auto crate = std::find_if(materials.begin(), materials.end(),
                                    [](const Material& m) { return m.name == "crate"; });
    ASSERT_NE(crate, materials.end());
    EXPECT_EQ(crate->roughness, 0.25f);
}

TEST(ViewerConduct, SaysInOneSentenceThatThereIsNoDisplay) {
    const char* display = std::getenv("DISPLAY");
    const std::string saved = display ? display : "";
    unsetenv("DISPLAY");
    const auto result = runPhat({"view", kScene});
    if (display) setenv("DISPLAY", saved.c_str(), 1);
    EXPECT_EQ(result.exitCode, 1);
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_EQ(result.err.rfind("phat: ", 0), 0u) << result.err;
}

}  // namespace
}  // namespace phat
