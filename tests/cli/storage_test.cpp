// phat bake --storage through the whole program.

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "io/image/image_file.h"
#include "support/run_program.h"

namespace phat {
namespace {

const std::string kScene = PHAT_SOURCE_DIR "/scenes/tabletop.glb";

struct Storage : testing::Test {
    TemporaryFolder folder;

    std::string baked(const std::string& storage) {
        const std::string out = folder.file(storage + ".phat.glb");
        const auto result = runPhat({"bake", kScene, "-o", out, "--resolution", "16k", "--photons", "5k",
                                     "--paths", "1", "--storage", storage, "--quiet"});
        EXPECT_EQ(result.exitCode, 0) << result.err;
        return out;
    }

    Image drawn(const std::string& file, const std::string& method) {
        const std::string out = folder.file("picture.exr");
        const auto result =
            runPhat({"render", file, "-o", out, "--method", method, "--component", "glossy-indirect",
                     "--size", "48x27", "--pixel-filter", "center", "--quiet"});
        EXPECT_EQ(result.exitCode, 0) << method << result.err;
        return readExr(out);
    }
};

double meanDifference(const Image& a, const Image& b) {
    double difference = 0, sum = 0;
    for (size_t i = 0; i < a.pixels.size(); ++i) {
        difference += glm::length(a.pixels[i] - b.pixels[i]);
        sum += glm::length(b.pixels[i]);
    }
    EXPECT_GT(sum, 0);
    return difference / sum;
}

TEST_F(Storage, EveryMethodDrawsBoth) {
    const std::string packed = baked("packed"), paper = baked("paper");
    // phat-paper reads no distance: what is left is the rounding of directions, by .0011 radians to halves
    // and as much to 24 bits. The steepest flank of a lobe of roughness .25 (alpha .0625) changes by 2 /
    // alpha a radian of the half vector, which turns half as far: a sample by 32 * .0022 / 2 = 3.5 %, up or
    // down.
    EXPECT_LT(meanDifference(drawn(paper, "phat-paper"), drawn(packed, "phat-paper")), 0.035);
    // These count on distances, and lose some of their sharpness without.
    for (const char* method : {"phat", "phat-pyramid", "phat-gather"}) {
        const double difference = meanDifference(drawn(paper, method), drawn(packed, method));
        EXPECT_GT(difference, 0) << method;
        EXPECT_LT(difference, 0.5) << method;
    }
}

TEST_F(Storage, InfoNamesIt) {
    for (const std::string storage : {"packed", "paper"}) {
        const std::string file = baked(storage);
        const auto said = nlohmann::json::parse(runPhat({"info", file, "--json"}).out)["bake"];
        EXPECT_EQ(said["storage"], storage);
        EXPECT_EQ(said["record"]["settings"].contains("storage"), storage == "paper");
        EXPECT_NE(runPhat({"info", file}).out.find("storage      " + storage + ": "), std::string::npos);
    }
}

TEST_F(Storage, APageIsRefusedBeforeAnythingIsWritten) {
    const std::string file = baked("paper");
    const auto result = runPhat({"web", file, "-o", folder.file("site"), "--poster-width", "64"});
    EXPECT_EQ(result.exitCode, 1);
    EXPECT_EQ(result.err, "phat: " + file +
                              ": has PHATexels in the paper's storage, which pages do not read: bake without "
                              "--storage paper\n");
    EXPECT_EQ(folder.fileCount(), 1u);
}

// Distances are all infinite in the pictures of an export.
TEST_F(Storage, ExportsAndBakesAgain) {
    const std::string file = baked("paper");
    ASSERT_EQ(runPhat({"export", file, "--exr", folder.file("maps")}).exitCode, 0);
    const Image distance = readExr(folder.file("maps/distance.exr"));
    const Image validity = readExr(folder.file("maps/validity.exr"));
    for (size_t i = 0; i < distance.pixels.size(); ++i)
        ASSERT_EQ(distance.pixels[i].x > 0, validity.pixels[i].x > 0);
    for (const glm::vec3& pixel : distance.pixels) ASSERT_TRUE(pixel.x == 0 || pixel.x >= 1e29f);
    const auto again = runPhat({"bake", file, "-o", folder.file("again.phat.glb"), "--resolution", "4k",
                                "--photons", "2k", "--paths", "1", "--quiet"});
    EXPECT_EQ(again.exitCode, 0) << again.err;
    const auto said = nlohmann::json::parse(runPhat({"info", folder.file("again.phat.glb"), "--json"}).out);
    EXPECT_EQ(said["bake"]["storage"], "packed");
}

}  // namespace
}  // namespace phat
