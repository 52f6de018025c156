// phat view as a child process.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>

#include "support/run_program.h"

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

}  // namespace
}  // namespace phat
