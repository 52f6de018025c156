// phat view driven by mouse and keys on a virtual screen.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <numeric>
#include <random>
#include <sstream>

#include "core/base/stopwatch.h"
#include "io/image/image_file.h"
#include "support/run_program.h"
#include "viewer/panels.h"
#include "viewer/screen_pictures.h"
#include "viewer/window_driver.h"
#include "viewer/window_exposure.h"

namespace phat {
namespace {

// Small, because software draws every pixel sixteen times before the window comes to rest.
constexpr glm::ivec2 kWindow(400, 320);
// Panels left, then the picture, in which the table is where the first camera sees it.
const int kPanelWidth = int(panelWidth(1));
const glm::ivec2 kPicture(kWindow.x - kPanelWidth, kWindow.y);
constexpr glm::ivec2 kTable(365, 242);
// A label lies over the picture's last lines.
constexpr int kLabelLines = 40;

// What the picture shows, its label left out.
Image pictureOf(const Image& screen) {
    return cut(screen, {kPanelWidth, 0}, {kPicture.x, kPicture.y - kLabelLines});
}

Image panelsOf(const Image& screen) {
    return cut(screen, {0, 0}, {kPanelWidth - 1, kWindow.y});
}

struct ViewerWindow : testing::Test {
    static void SetUpTestSuite() {
        folder = new TemporaryFolder;
        const auto result = runPhat({"bake", PHAT_SOURCE_DIR "/scenes/tabletop.glb", "-o", baked(),
                                     "--resolution", "64k", "--photons", "50k", "--quiet"});
        ASSERT_EQ(result.exitCode, 0) << result.err;
    }
    static void TearDownTestSuite() { delete folder; }
    static std::string baked() { return folder->file("tabletop.phat.glb"); }

    // What `phat render` makes of the first camera in the window's shape.
    static Image rendered(const std::string& name, std::vector<std::string> flags = {}) {
        const std::string out = folder->file(name);
        std::vector<std::string> words = {"render",
                                          baked(),
                                          "-o",
                                          out,
                                          "--spp",
                                          "16",
                                          "--quiet",
                                          "--size",
                                          std::to_string(kPicture.x) + "x" + std::to_string(kPicture.y),
                                          "--exposure",
                                          windowExposure(baked())};
        words.insert(words.end(), flags.begin(), flags.end());
        const auto result = runPhat(words);
        EXPECT_EQ(result.exitCode, 0) << result.err;
        return readPicture(out);
    }

    static inline TemporaryFolder* folder = nullptr;
};

TEST_F(ViewerWindow, ShowsWhatRenderWrites) {
    WindowDriver window(kWindow, {baked()});
    window.settle();
    const Image seen = pictureOf(window.screenshot());
    const Image expected = cut(srgb(rendered("start.png")), {0, 0}, {kPicture.x, kPicture.y - kLabelLines});
    // Both round to 8 bits, and the two tone maps compute in another order.
    EXPECT_LE(largestDifference(seen, expected), 2.5f / 255);
    EXPECT_EQ(window.close(), 0);
    EXPECT_EQ(window.errors(), "");
}

TEST_F(ViewerWindow, OrbitsAndComesBack) {
    WindowDriver window(kWindow, {baked()});
    window.settle();
    const Image start = window.screenshot();
    window.drag({360, 180}, {390, 190});
    window.settle();
    const Image turned = window.screenshot();
    EXPECT_GT(meanDifference(pictureOf(turned), pictureOf(start)), 0.02);
    window.key("Home");
    window.settle();
    EXPECT_EQ(largestDifference(pictureOf(window.screenshot()), pictureOf(start)), 0);
    window.wheel(2);
    window.settle();
    EXPECT_GT(meanDifference(pictureOf(window.screenshot()), pictureOf(start)), 0.02);
    EXPECT_EQ(window.close(), 0);
}

TEST_F(ViewerWindow, EditsWithoutANewBakeAsSetDoes) {
    WindowDriver window(kWindow, {baked()});
    window.settle();
    const Image start = window.screenshot();
    window.click(kTable);
    window.settle();
    EXPECT_EQ(largestDifference(pictureOf(window.screenshot()), pictureOf(start)), 0);
    window.key("l");  // as `--set` does, the light waits
    window.drag(window.pixelOnWidget("Roughness", 0.4f), window.pixelOnWidget("Roughness", 0.8f));
    window.settle();
    EXPECT_GT(meanDifference(pictureOf(window.screenshot()), pictureOf(start)), 0.005);
    window.clickWidget("Roughness", true);
    window.type("0.5");
    window.key("Return");
    window.settle();
    const Image edited = window.screenshot();
    window.key("p");
    window.settle();
    const Image kept = readPicture(savedFile(window.folder().file("phat-0001.exr")));
    const Image set = rendered("set.exr", {"--set", "table_top.roughness=0.5"});
    EXPECT_LE(largestDifference(kept, set), 1e-5f);
    EXPECT_GT(meanDifference(kept, rendered("unset.exr")), 1e-3);  // or the edit did nothing

    // The command that the window offers makes the same picture.
    window.clickWidget("Output");
    window.settle();
    window.clickWidget("Copy render command");
    window.settle();
    std::istringstream command(window.clipboard());
    std::vector<std::string> words;
    for (std::string word; command >> word;) words.push_back(word);
    ASSERT_GE(words.size(), 5u);
    EXPECT_EQ(words[0] + " " + words[1], "phat render");
    words.erase(words.begin());
    *(std::find(words.begin(), words.end(), "-o") + 1) = folder->file("copied.png");
    const auto result = runPhat(words);
    EXPECT_EQ(result.exitCode, 0) << result.err;
    EXPECT_LE(largestDifference(cut(srgb(readPicture(folder->file("copied.png"))), {0, 0},
                                    {kPicture.x, kPicture.y - kLabelLines}),
                                pictureOf(edited)),
              2.5f / 255);

    window.key("ctrl+z");
    window.key("ctrl+z");
    window.settle();
    EXPECT_EQ(largestDifference(pictureOf(window.screenshot()), pictureOf(start)), 0);
    EXPECT_EQ(window.close(), 0);
}

// Means of squares of pixels: what is left is what changed in the large, however coarse the picture is.
Image inBlocks(const Image& image) {
    constexpr int kSide = 10;
    Image blocks(image.width / kSide, image.height / kSide);
    for (int y = 0; y < blocks.height * kSide; ++y)
        for (int x = 0; x < blocks.width * kSide; ++x)
            blocks.at(x / kSide, y / kSide) += image.at(x, y) / float(kSide * kSide);
    return blocks;
}

// No frame shows a slider's new value beside a picture of the old one.
TEST_F(ViewerWindow, ShowsAnEditInTheFrameThatTakesIt) {
    WindowDriver window(kWindow, {baked()});
    window.settle();
    window.click(kTable);
    window.settle();
    window.moveTo(window.pixelOnWidget("Roughness", 0.8f));
    window.settle();
    const Image before = window.screenshot();
    window.hold(1, true);
    Image first = window.screenshot();
    for (int i = 0; i < 10'000 && largestDifference(panelsOf(first), panelsOf(before)) == 0; ++i)
        first = window.screenshot();
    window.hold(1, false);
    window.settle();
    const Image after = inBlocks(pictureOf(window.screenshot())), seen = inBlocks(pictureOf(first));
    // The slower the machine, the coarser is the first picture; it is nearer to the one that it becomes.
    EXPECT_LT(meanDifference(seen, after), meanDifference(seen, inBlocks(pictureOf(before))));
    EXPECT_EQ(window.close(), 0);
}

TEST_F(ViewerWindow, WipesBetweenTwoPictures) {
    WindowDriver window(kWindow, {baked()});
    window.settle();
    const Image start = pictureOf(window.screenshot());
    // The path tracer stands right of the line as soon as its first pass is there.
    window.key("c");
    const int middle = kPicture.x / 2, height = start.height;
    const auto halves = [&](int line) {
        const Image seen = pictureOf(window.screenshot());
        const glm::ivec2 left(line - 4, height), right(kPicture.x - line - 4, height);
        return std::pair(meanDifference(cut(seen, {0, 0}, left), cut(start, {0, 0}, left)),
                         meanDifference(cut(seen, {line + 4, 0}, right), cut(start, {line + 4, 0}, right)));
    };
    // The difference of single samples while it refines is above the first, the noise of few paths above the
    // second.
    EXPECT_TRUE(comesTrue([&] {
        const auto [left, right] = halves(middle);
        return left <= 0.002 && right > 0.01;
    }));
    window.drag({kPanelWidth + middle, 100}, {kPanelWidth + middle + 20, 100});
    EXPECT_TRUE(comesTrue([&] { return halves(middle + 20).first <= 0.002; }));
    window.key("c");
    window.settle();
    EXPECT_EQ(largestDifference(pictureOf(window.screenshot()), start), 0);
    EXPECT_EQ(window.close(), 0);
}

TEST_F(ViewerWindow, SleepsAndNoticesThatItsFileChanged) {
    const std::string path = folder->file("changing.phat.glb");
    std::filesystem::copy_file(baked(), path);
    WindowDriver window(kWindow, {path});
    window.moveTo({365, 100});
    window.settle();
    const Image start = window.screenshot();
    expectSleep(window);
    std::filesystem::last_write_time(path, std::filesystem::last_write_time(path) + std::chrono::seconds(5));
    window.pixelOnWidget("Reload", 0.5f);  // waits for it
    window.settle();
    const Image offered = window.screenshot();
    EXPECT_GT(meanDifference(panelsOf(offered), panelsOf(start)), 0.005);
    EXPECT_EQ(largestDifference(pictureOf(offered), pictureOf(start)), 0);
    window.clickWidget("Reload");
    window.moveTo({365, 100});  // over nothing that lights up
    window.settle();
    EXPECT_EQ(largestDifference(pictureOf(window.screenshot()), pictureOf(start)), 0);
    EXPECT_LE(meanDifference(panelsOf(window.screenshot()), panelsOf(start)), 0.002);
    EXPECT_EQ(window.close(), 0);
}

TEST_F(ViewerWindow, ShowsPhatexelsAndThePyramid) {
    WindowDriver window(kWindow, {baked()});
    window.settle();
    const Image start = pictureOf(window.screenshot());
    window.clickWidget("Method");
    window.settle();
    window.clickWidget("Method/phat-pyramid");
    window.settle();
    const Image pyramid = pictureOf(window.screenshot());
    const Image expected = cut(srgb(rendered("pyramid.png", {"--method", "phat-pyramid"})), {0, 0},
                               {kPicture.x, kPicture.y - kLabelLines});
    EXPECT_GT(meanDifference(pyramid, start), 0.002);
    EXPECT_LE(largestDifference(pyramid, expected), 2.5f / 255);
    EXPECT_EQ(window.close(), 0);
}

TEST_F(ViewerWindow, TellsInOneSentenceWhatIsWrong) {
    const std::string broken = PHAT_SOURCE_DIR "/tests/data/broken/03-truncated-3.glb";
    {
        WindowDriver window(kWindow, {}, {});
        window.settle();
        EXPECT_EQ(window.close(), 0);
    }
    const auto firstWords = [](std::vector<std::string> arguments, std::vector<std::string> variables) {
        try {
            WindowDriver window(kWindow, std::move(arguments), variables);
        } catch (const std::exception& error) {
            return std::string(error.what());
        }
        return std::string("a window opened");
    };
    const std::string unread = firstWords({broken}, {});
    EXPECT_NE(unread.find("phat: " + broken), std::string::npos) << unread;
    EXPECT_EQ(std::count(unread.begin(), unread.end(), '\n'), 1) << unread;
    const std::string old = firstWords({baked()}, {"MESA_GL_VERSION_OVERRIDE=3.3"});
    EXPECT_NE(old.find("OpenGL 4.5"), std::string::npos) << old;
    EXPECT_EQ(std::count(old.begin(), old.end(), '\n'), 1) << old;
}

// What the same hands do again and again takes no more memory once all has been used.
TEST_F(ViewerWindow, RepeatedUseTakesNoMoreMemory) {
    constexpr int kFirstRounds = 3, kRounds = 6;
    WindowDriver window(kWindow, {baked()});
    window.settle();
    window.click(kTable);
    double before = 0, after = 0;
    for (int round = 0; round < kRounds; ++round) {
        window.drag(window.pixelOnWidget("Roughness", 0.4f), window.pixelOnWidget("Roughness", 0.8f));
        window.drag({360, 180}, {390, 190});
        window.key("ctrl+z");
        for (const char* key : {"c", "c", "Tab", "Tab", "f", "Home"}) window.key(key);
        after = double(window.residentBytes()) * 1e-6;
        if (round < kFirstRounds) before = after;
    }
    // A twentieth is for the allocators; a picture's targets left behind by each action, or a megabyte by
    // each frame, are more.
    EXPECT_LT(after, 1.05 * before);
    EXPECT_EQ(window.close(), 0);
    EXPECT_EQ(window.errors(), "");
}

// Everything that hands can do, in an order of chance. PHAT_SOAK_SECONDS makes it longer than the suite's
// moment.
TEST_F(ViewerWindow, SurvivesLongUseInFlatMemory) {
    const char* wanted = std::getenv("PHAT_SOAK_SECONDS");
    const double seconds = wanted ? std::atof(wanted) : 10;
    const std::string path = folder->file("used.phat.glb");
    std::filesystem::copy_file(baked(), path, std::filesystem::copy_options::overwrite_existing);
    WindowDriver window(kWindow, {path});
    std::mt19937 random(1);
    const auto below = [&](int n) { return int(random() % unsigned(n)); };
    const auto inPicture = [&] {
        return glm::ivec2(kPanelWidth + 5 + below(kPicture.x - 10), 5 + below(kPicture.y - 10));
    };
    const auto inPanels = [&] {
        return glm::ivec2(10 + below(kPanelWidth - 30), 30 + below(kWindow.y - 40));
    };
    const char* const keys[] = {"f", "Home", "c", "Tab", "Tab", "Escape", "ctrl+z", "ctrl+y",
                                "w", "a",    "e", "g",   "r",   "x",      "Return", "l"};
    const Stopwatch watch;
    std::vector<double> megabytes;  // at equal times, 12 of a run
    int actions = 0;
    for (; watch.seconds() < seconds; ++actions) {
        if (watch.seconds() > seconds / 12 * double(megabytes.size() + 1))
            megabytes.push_back(double(window.residentBytes()) * 1e-6);
        switch (below(8)) {
            case 0:
                window.drag(inPicture(), inPicture(), 1 + below(3));
                break;
            case 1:
                window.wheel(below(2) ? 1 : -1);
                break;
            case 2:
                window.click(inPicture());
                break;
            case 3:
                window.click(inPanels());
                break;
            case 4:
                window.drag(inPanels(), inPanels());
                break;
            case 5:
                if (below(20) == 0) window.key("ctrl+s");
                break;
            default:
                window.key(keys[below(int(std::size(keys)))]);
        }
        ASSERT_TRUE(window.running()) << actions << " actions: " << window.errors();
    }
    if (wanted) {
        std::printf("%d actions; MB, 12 times:", actions);
        for (const double mb : megabytes) std::printf(" %.0f", mb);
        std::printf("\n");
    }
    megabytes.push_back(double(window.residentBytes()) * 1e-6);
    // The first sixth is for what is made when it is first used; in a short run, that goes on to its end.
    const auto begin = megabytes.begin() + long(megabytes.size() / 6);
    const auto middle = begin + long((megabytes.end() - begin) / 2);
    const auto mean = [](auto from, auto to) { return std::accumulate(from, to, 0.0) / double(to - from); };
    ASSERT_LT(begin, middle);
    const double growth = mean(middle, megabytes.end()) / mean(begin, middle);
    EXPECT_TRUE(seconds < 360 || growth < 1.1) << growth;
    EXPECT_EQ(window.close(), 0) << window.errors();
    EXPECT_EQ(window.errors(), "");
}

}  // namespace
}  // namespace phat
