// The font of the panels is the one that fontconfig has for "sans-serif".

#include <gtest/gtest.h>

#include "viewer/screen_pictures.h"
#include "viewer/window_driver.h"

namespace phat {
namespace {

// What an empty window shows with a configuration of fontconfig.
Image windowWith(const std::string& configuration) {
    const TemporaryFolder folder;
    const std::string file = folder.file("fonts.conf");
    std::ofstream(file) << "<fontconfig><cachedir>" << folder.file("cache") << "</cachedir>" << configuration
                        << "</fontconfig>";
    WindowDriver window({400, 60}, {}, {"FONTCONFIG_FILE=" + file});
    window.settle();
    const Image shown = window.screenshot();
    EXPECT_EQ(window.close(), 0);
    EXPECT_EQ(window.errors().find("phat:"), std::string::npos) << window.errors();
    return shown;
}

TEST(Font, IsTheSansSerifOfFontconfig) {
#ifndef PHAT_FONTCONFIG
    GTEST_SKIP() << "built without fontconfig";
#endif
    // The families of the Debian package fonts-dejavu-core.
    const auto alias = [](const std::string& family) {
        return "<dir>/usr/share/fonts</dir><match><test name=\"family\"><string>sans-serif</string></test>"
               "<edit name=\"family\" mode=\"assign\" binding=\"strong\"><string>" +
               family + "</string></edit></match>";
    };
    const Image sans = windowWith(alias("DejaVu Sans")), mono = windowWith(alias("DejaVu Sans Mono"));
    const Image none = windowWith("");
    EXPECT_GT(meanDifference(sans, mono), 0.01);
    EXPECT_GT(meanDifference(sans, none), 0.01);
    EXPECT_GT(meanDifference(mono, none), 0.01);
    EXPECT_EQ(largestDifference(windowWith(alias("DejaVu Sans")), sans), 0);
}

}  // namespace
}  // namespace phat
