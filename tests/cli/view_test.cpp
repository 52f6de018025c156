// phat view as a child process.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>

#include "support/run_program.h"
#include "support/temporary_folder.h"
#include "support/variant_scene.h"

namespace phat {
namespace {

const std::string kScene = PHAT_SOURCE_DIR "/scenes/tabletop.glb";

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

// Both are found out before a window opens.
TEST(ViewerConduct, VariantsAreOfScenesThatAreNotBaked) {
    const TemporaryFolder folder;
    const std::string text = sceneWithVariants(), path = folder.file("room.gltf"),
                      baked = folder.file("room.phat.glb");
    writeBytes(path, {text.begin(), text.end()});
    ASSERT_EQ(
        runPhat({"bake", path, "-o", baked, "--resolution", "1k", "--photons", "1k", "--quiet"}).exitCode, 0);
    const auto result = runPhat({"view", baked, "--variant", "dark"});
    EXPECT_EQ(result.exitCode, 2);
    EXPECT_NE(result.err.find("--variant: the bake is of one variant"), std::string::npos) << result.err;
    EXPECT_EQ(runPhat({"view", "--variant", "dark"}).exitCode, 2);
}

}  // namespace
}  // namespace phat
