#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "core/render/metrics.h"
#include "io/image/image_file.h"
#include "support/run_program.h"
#include "support/temporary_folder.h"

namespace phat {
namespace {

struct CompareCommand : testing::Test {
    CompareCommand() {
        for (int y = 0; y < 12; ++y)
            for (int x = 0; x < 16; ++x) {
                reference.at(x, y) = glm::vec3(0.2f + 0.01f * float(x), 0.4f, 0.05f * float(y));
                test.at(x, y) = reference.at(x, y) * (x < 8 ? 1.25f : 0.9f);
                mask.at(x, y) = glm::vec3(x < 8 ? 1 : 0);
            }
        writeExr(referencePath, reference);
        writeExr(testPath, test);
        writeExr(maskPath, mask);
    }

    TemporaryFolder folder;
    Image reference{16, 12}, test{16, 12}, mask{16, 12};
    std::string referencePath = folder.file("reference.exr"), testPath = folder.file("test.exr"),
                maskPath = folder.file("mask.exr");
};

// One line on stderr that names the file, nothing on stdout, exit code 1.
void expectFailure(const ProgramResult& result, const std::string& path, const std::string& reason) {
    EXPECT_EQ(result.exitCode, 1);
    EXPECT_EQ(result.out, "");
    EXPECT_EQ(result.err.rfind("phat: " + path + ": ", 0), 0u) << result.err;
    EXPECT_NE(result.err.find(reason), std::string::npos) << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
}

TEST_F(CompareCommand, JsonHasTheFiguresOfTheLibrary) {
    for (const bool masked : {false, true}) {
        std::vector<std::string> arguments{"compare", testPath, referencePath, "--json"};
        if (masked) arguments.insert(arguments.end(), {"--mask", maskPath});
        const ProgramResult result = runPhat(arguments);
        ASSERT_EQ(result.exitCode, 0) << result.err;
        const auto report = nlohmann::json::parse(result.out);
        const Metrics expected = compareImages(test, reference, masked ? &mask : nullptr);
        EXPECT_EQ(report["relMse"], expected.relMse);
        EXPECT_EQ(report["maeOverMean"], expected.maeOverMean);
        EXPECT_EQ(report["bias"], expected.bias);
        EXPECT_EQ(report["flip"], expected.flip);
        EXPECT_EQ(report["pixels"], masked ? 96 : 192);
        if (masked) {
            EXPECT_NEAR(expected.bias, 0.25, 1e-6);
        }
    }
}

TEST_F(CompareCommand, TableIsForPeople) {
    const ProgramResult result = runPhat({"compare", testPath, referencePath, "--mask", maskPath});
    EXPECT_EQ(result.exitCode, 0);
    EXPECT_NE(result.out.find("bias       +0.250000\n"), std::string::npos) << result.out;
    EXPECT_NE(result.out.find("pixels            96 of 192\n"), std::string::npos) << result.out;
}

TEST_F(CompareCommand, NoiseOfTheReferenceOnRequest) {
    const std::string variance = folder.file("variance.exr");
    Image v(16, 12);
    for (size_t i = 0; i < v.pixels.size(); ++i)
        v.pixels[i] = 0.01f * reference.pixels[i] * reference.pixels[i];
    writeExr(variance, v);
    const ProgramResult result = runPhat({"compare", testPath, referencePath, "--variance", variance});
    // A tenth of the value as sigma everywhere.
    EXPECT_NE(result.out.find("noise       0.0797"), std::string::npos) << result.out;
    EXPECT_EQ(runPhat({"compare", testPath, referencePath}).out.find("noise"), std::string::npos);
}

TEST_F(CompareCommand, ExposureChangesFlipAlone) {
    const auto at = [&](const char* stops) {
        return nlohmann::json::parse(
            runPhat({"compare", testPath, referencePath, "--json", "--exposure", stops}).out);
    };
    const auto dark = at("-3"), bright = at("0");
    EXPECT_LT(dark["flip"], bright["flip"]);
    EXPECT_DOUBLE_EQ(dark["relMse"], bright["relMse"]);
    EXPECT_DOUBLE_EQ(dark["bias"], bright["bias"]);
}

TEST_F(CompareCommand, SignedPictureShowsWhichWay) {
    const std::string out = folder.file("difference.png");
    ASSERT_EQ(runPhat({"compare", testPath, referencePath, "--map", "signed", "--out", out}).exitCode, 0);
    const Image picture = readPng(out);
    ASSERT_EQ(picture.width, 16);
    ASSERT_EQ(picture.height, 12);
    EXPECT_GT(picture.at(2, 5).x, picture.at(2, 5).z);    // too bright: red
    EXPECT_LT(picture.at(13, 5).x, picture.at(13, 5).z);  // too dark: blue
}

TEST_F(CompareCommand, FlipPictureIsDarkWhereNothingDiffers) {
    Image same = reference;
    for (int y = 0; y < 12; ++y) same.at(0, y) = glm::vec3(1);
    writeExr(testPath, same);
    const std::string out = folder.file("difference.png");
    ASSERT_EQ(runPhat({"compare", testPath, referencePath, "--out", out}).exitCode, 0);
    const Image picture = readPng(out);
    EXPECT_LT(luminance(picture.at(15, 6)), 1e-3f);
    EXPECT_GT(luminance(picture.at(0, 6)), 0.1f);
}

TEST_F(CompareCommand, BadInputIsOneSentence) {
    writeExr(folder.file("small.exr"), Image(8, 12));
    expectFailure(runPhat({"compare", folder.file("small.exr"), referencePath}), folder.file("small.exr"),
                  "is 8 x 12 pixels, but");
    expectFailure(runPhat({"compare", testPath, referencePath, "--mask", folder.file("small.exr")}),
                  folder.file("small.exr"), "is 8 x 12 pixels, but");
    expectFailure(runPhat({"compare", folder.file("missing.exr"), referencePath}), folder.file("missing.exr"),
                  "no such file");
    writeExr(folder.file("black.exr"), Image(16, 12));
    expectFailure(runPhat({"compare", testPath, referencePath, "--mask", folder.file("black.exr")}),
                  folder.file("black.exr"), "keeps no pixel");
    const std::string out = folder.file("no/folder.png");
    expectFailure(runPhat({"compare", testPath, referencePath, "--out", out}), out, "No such file");
}

TEST_F(CompareCommand, PixelsThatAreNoNumbersAreNotAveragedAway) {
    test.at(3, 3).y = std::numeric_limits<float>::quiet_NaN();
    test.at(4, 3).x = std::numeric_limits<float>::infinity();
    writeExr(testPath, test);
    expectFailure(runPhat({"compare", testPath, referencePath}), testPath, "2 of 192 pixels");
    expectFailure(runPhat({"compare", referencePath, testPath}), testPath, "2 of 192 pixels");
}

TEST_F(CompareCommand, WrongUsageIsTwo) {
    EXPECT_EQ(runPhat({}).exitCode, 2);
    EXPECT_EQ(runPhat({"compare", testPath}).exitCode, 2);
    EXPECT_EQ(runPhat({"compare", testPath, referencePath, "--map", "heat"}).exitCode, 2);
    EXPECT_EQ(runPhat({"compare", testPath, referencePath, "--exposure", "much"}).exitCode, 2);
    EXPECT_EQ(runPhat({"compare", testPath, referencePath, "--no-such-option"}).exitCode, 2);
    EXPECT_EQ(runPhat({"no-such-command"}).exitCode, 2);
    EXPECT_EQ(runPhat({"--help"}).exitCode, 0);
    EXPECT_EQ(runPhat({"compare", "--help"}).exitCode, 0);
    EXPECT_EQ(runPhat({"--version"}).out.rfind("phat ", 0), 0u);
}

}  // namespace
}  // namespace phat
