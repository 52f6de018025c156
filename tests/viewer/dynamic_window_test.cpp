// What is moved in the window, and the light that follows.

#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>

#include "io/image/image_file.h"
#include "support/run_program.h"
#include "viewer/panels.h"
#include "viewer/screen_pictures.h"
#include "viewer/window_driver.h"
#include "viewer/window_exposure.h"

namespace phat {
namespace {

// Half as large as usual: software draws every pixel many times.
constexpr glm::ivec2 kWindow(265, 160);
const int kPanelWidth = int(panelWidth(0.5f));
const glm::ivec2 kPicture(kWindow.x - kPanelWidth, kWindow.y);
constexpr glm::ivec2 kCrate(183, 67), kGlobe(258, 65);
constexpr int kLabelLines = 20;

Image pictureOf(const Image& screen) {
    return cut(screen, {kPanelWidth, 0}, {kPicture.x, kPicture.y - kLabelLines});
}

struct LiveWindow : testing::Test {
    static void SetUpTestSuite() {
        folder = new TemporaryFolder;
        bake(PHAT_SOURCE_DIR "/scenes/tabletop-animated.glb", baked());
    }
    static void TearDownTestSuite() { delete folder; }
    static std::string baked() { return folder->file("tabletop.phat.glb"); }
    static void bake(const std::string& scene, const std::string& out,
                     const std::string& resolution = "16k") {
        const auto result =
            runPhat({"bake", scene, "-o", out, "--resolution", resolution, "--photons", "20k", "--quiet"});
        ASSERT_EQ(result.exitCode, 0) << result.err;
    }
    static Image rendered(const std::string& file, std::vector<std::string> flags = {}) {
        const std::string out = folder->file("rendered.exr");
        std::vector<std::string> words = {
            "render",  file,     "-o",
            out,       "--spp",  "16",
            "--quiet", "--size", std::to_string(kPicture.x) + "x" + std::to_string(kPicture.y)};
        words.insert(words.end(), flags.begin(), flags.end());
        const auto result = runPhat(words);
        EXPECT_EQ(result.exitCode, 0) << result.err;
        const bool frames = !flags.empty();
        return readPicture(frames ? folder->file("rendered.0000.exr") : out);
    }
    static inline TemporaryFolder* folder = nullptr;
};

/// The scene as a file in which the crate stands elsewhere.
void writeMovedScene(const std::string& out, double meters) {
    const auto bytes = readBytes(PHAT_SOURCE_DIR "/scenes/tabletop-animated.glb");
    uint32_t length = 0;
    std::memcpy(&length, bytes.data() + 12, 4);
    auto gltf = nlohmann::json::parse(bytes.begin() + 20, bytes.begin() + 20 + length);
    for (auto& node : gltf["nodes"])
        if (node.value("name", "") == "crate")
            node["translation"][0] = node["translation"][0].get<double>() + meters;
    std::string text = gltf.dump();
    text.resize((text.size() + 3) / 4 * 4, ' ');
    std::string file(bytes.begin(), bytes.begin() + 20);
    const uint32_t newLength = uint32_t(text.size()), whole = uint32_t(bytes.size()) - length + newLength;
    std::memcpy(file.data() + 8, &whole, 4);
    std::memcpy(file.data() + 12, &newLength, 4);
    file += text;
    file.append(bytes.begin() + 20 + length, bytes.end());
    std::ofstream(out, std::ios::binary) << file;
}

void moveCrate(WindowDriver& window, const std::string& meters) {
    window.click(kCrate);
    window.settle();
    window.key("g");
    window.key("x");
    window.type(meters);
    window.key("Return");
}

TEST_F(LiveWindow, LightFollowsWhatIsMoved) {
    const auto before = readBytes(baked());
    WindowDriver window(kWindow, {baked(), "--ui-scale", "0.5"});
    window.settle();
    const Image start = window.screenshot();
    moveCrate(window, "0.15");
    window.settle();
    window.key("p");
    window.settle();
    const Image kept = readPicture(savedFile(window.folder().file("phat-0001.exr")));

    // It is the picture of a bake with the crate there, but for another atlas: a fiftieth of the change. Two
    // seeds of so coarse a bake are a third of it apart; light that stays behind (below) would be a seventh.
    writeMovedScene(folder->file("moved.glb"), 0.15);
    bake(folder->file("moved.glb"), folder->file("moved.phat.glb"));
    const Image expected = rendered(folder->file("moved.phat.glb")), unmoved = rendered(baked());
    EXPECT_GT(meanDifference(unmoved, expected), 0.02);
    EXPECT_LT(meanDifference(kept, expected), 0.1 * meanDifference(unmoved, expected));

    // Without the light that follows, the old light stays where it was; rays show the crate where it is,
    // though.
    window.key("l");
    window.key("ctrl+z");
    window.settle();
    const Image unlit = pictureOf(window.screenshot());
    EXPECT_GT(meanDifference(unlit, pictureOf(start)), 0.002);
    window.key("l");
    window.settle();
    window.click({kPanelWidth + 10, 10});  // the wall, instead of the crate
    window.settle();
    EXPECT_EQ(largestDifference(pictureOf(window.screenshot()), pictureOf(start)), 0);
    EXPECT_EQ(window.close(), 0);
    EXPECT_EQ(window.errors(), "");
    EXPECT_EQ(readBytes(baked()), before);
}

// Of few texels, and not to its end: a software driver takes minutes. The change was made while light waited.
TEST_F(LiveWindow, LightOfTheGpuFollowsOnceItIsAskedTo) {
    const std::string few = folder->file("few.phat.glb");
    bake(PHAT_SOURCE_DIR "/scenes/tabletop-animated.glb", few, "4k");
    const auto before = readBytes(few);
    WindowDriver window(kWindow, {few, "--engine", "gpu", "--ui-scale", "0.5"});
    window.settle();
    window.key("l");
    moveCrate(window, "0.15");
    window.settle();
    const Image unlit = pictureOf(window.screenshot());
    window.key("l");
    EXPECT_TRUE(comesTrue([&] { return meanDifference(pictureOf(window.screenshot()), unlit) > 0.002; }));
    // Frames are drawn while the light is made.
    const Image first = pictureOf(window.screenshot());
    EXPECT_TRUE(comesTrue([&] { return largestDifference(pictureOf(window.screenshot()), first) > 0; }));
    EXPECT_EQ(window.close(), 0);
    EXPECT_EQ(window.errors(), "");
    EXPECT_EQ(readBytes(few), before);
}

// The window's picture comes nearer to that of many bakes, and rests once nobody wants more.
TEST_F(LiveWindow, RefinesAtRest) {
    WindowDriver window(kWindow, {baked(), "--ui-scale", "0.5"});
    window.settle();
    const Image plain = pictureOf(window.screenshot());
    const std::string out = folder->file("refined.png");
    const auto result = runPhat({"render", baked(), "-o", out, "--refine", "7", "--quiet", "--exposure",
                                 windowExposure(baked()), "--size",
                                 std::to_string(kPicture.x) + "x" + std::to_string(kPicture.y)});
    ASSERT_EQ(result.exitCode, 0) << result.err;
    const Image expected = cut(srgb(readPicture(out)), {0, 0}, {kPicture.x, kPicture.y - kLabelLines});
    EXPECT_GT(meanDifference(plain, expected), 0.002);
    window.key("shift+l");
    const auto isNearer = [&] {
        const Image refined = pictureOf(window.screenshot());
        return meanDifference(refined, expected) < 0.8 * meanDifference(plain, expected);
    };
    EXPECT_TRUE(comesTrue(isNearer));
    window.key("shift+l");
    window.settle();
    EXPECT_TRUE(isNearer());
    EXPECT_EQ(window.close(), 0);
    EXPECT_EQ(window.errors(), "");
}

TEST_F(LiveWindow, MovesWithTheMouseAndBack) {
    WindowDriver window(kWindow, {baked(), "--ui-scale", "0.5"});
    window.settle();
    const Image start = pictureOf(window.screenshot());
    window.key("l");
    window.click(kGlobe);
    window.settle();
    for (const char* kind : {"g", "r"}) {
        window.key(kind);
        window.moveTo(kGlobe + glm::ivec2(-15, -10));
        window.moveTo(kGlobe + glm::ivec2(-30, -15));
        window.settle();
        EXPECT_GT(meanDifference(pictureOf(window.screenshot()), start), 0.01) << kind;
        window.key("Escape");
        window.moveTo(kGlobe);
    }
    window.key("l");
    window.settle();
    EXPECT_EQ(largestDifference(pictureOf(window.screenshot()), start), 0);
    EXPECT_EQ(window.close(), 0);
}

TEST_F(LiveWindow, ScrubsAndPlaysTheFilesAnimation) {
    WindowDriver window(kWindow, {baked(), "--ui-scale", "0.5"});
    window.settle();
    const Image start = pictureOf(window.screenshot());
    window.clickWidget("Time, s", true);
    window.type("1");
    window.key("Return");
    window.settle();
    window.key("p");
    window.settle();
    const Image kept = readPicture(savedFile(window.folder().file("phat-0001.exr")));
    const Image expected =
        rendered(baked(), {"--animate", "1:1", "--fps", "1", "--work-per-frame", "1000000"});
    EXPECT_GT(meanDifference(expected, rendered(baked())), 0.01);
    EXPECT_LE(largestDifference(kept, expected), 1e-5f);

    window.key("space");
    window.moveTo({kPanelWidth + 10, 10});
    const Image first = pictureOf(window.screenshot());
    EXPECT_TRUE(comesTrue([&] { return meanDifference(pictureOf(window.screenshot()), first) > 0.002; }));
    window.key("space");
    window.settle();
    expectSleep(window);
    EXPECT_GT(meanDifference(pictureOf(window.screenshot()), start), 0.002);
    EXPECT_EQ(window.close(), 0);
    EXPECT_EQ(window.errors(), "");
}

}  // namespace
}  // namespace phat
