#include <gtest/gtest.h>

#include <cmath>

#include "io/base/file_error.h"
#include "io/gltf/gltf_loader.h"
#include "io/image/image_file.h"
#include "support/temporary_folder.h"

namespace phat {
namespace {

TEST(Environment, ExrKeepsLightAndLosesWhatIsNone) {
    const TemporaryFolder folder;
    Image sky(4, 2, glm::vec3(0.25f, 0.5f, 3e4f));
    sky.at(1, 0) = {-0.001f, NAN, 7};
    sky.at(2, 1) = {INFINITY, 0, 1};
    writeExr(folder.file("sky.exr"), sky);
    std::vector<std::string> notes;
    const Image loaded = loadEnvironment(folder.file("sky.exr"), &notes).radiance;
    ASSERT_EQ(loaded.width, 4);
    ASSERT_EQ(loaded.height, 2);
    EXPECT_EQ(loaded.at(0, 0), glm::vec3(0.25f, 0.5f, 3e4f));
    EXPECT_EQ(loaded.at(1, 0), glm::vec3(0, 0, 7));
    EXPECT_EQ(loaded.at(2, 1), glm::vec3(65504, 0, 1));
    ASSERT_EQ(notes.size(), 2u);
    EXPECT_NE(notes[0].find("1 infinite pixels are taken for a radiance of 65504"), std::string::npos)
        << notes[0];
    EXPECT_NE(notes[1].find("1 pixels that are no numbers"), std::string::npos) << notes[1];
}

// An infinite sun is no darker than the rest, and no sum of it leaves the range of floats.
TEST(Environment, InfiniteIsTheBrightest) {
    const TemporaryFolder folder;
    Image sky(4, 2, glm::vec3(1));
    sky.at(0, 0) = glm::vec3(2e5f);
    sky.at(1, 0) = glm::vec3(INFINITY);
    sky.at(3, 1) = {-INFINITY, 1, 1};
    writeExr(folder.file("sky.exr"), sky);
    const Image loaded = loadEnvironment(folder.file("sky.exr")).radiance;
    EXPECT_EQ(loaded.at(1, 0), glm::vec3(2e5f));
    EXPECT_EQ(loaded.at(3, 1), glm::vec3(0, 1, 1));
    sky.at(2, 0) = glm::vec3(3e38f);
    writeExr(folder.file("bright.exr"), sky);
    std::vector<std::string> notes;
    EXPECT_EQ(loadEnvironment(folder.file("bright.exr"), &notes).radiance.at(2, 0), glm::vec3(1e9f));
    EXPECT_EQ(notes.size(), 1u);
}

TEST(Environment, HdrByItsContentNotItsName) {
    const TemporaryFolder folder;
    const std::string header = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n";
    std::vector<char> bytes(header.begin(), header.end());
    // RGBE: mantissa / 256 * 2^(E - 128)
    for (const int value : {128, 64, 32, 129, 0, 255, 0, 130}) bytes.push_back(char(value));
    writeBytes(folder.file("sky.exr"), bytes);
    const Image loaded = loadEnvironment(folder.file("sky.exr")).radiance;
    ASSERT_EQ(loaded.width, 2);
    EXPECT_NEAR(glm::distance(loaded.at(0, 0), glm::vec3(1, 0.5f, 0.25f)), 0, 1e-2f);
    EXPECT_NEAR(loaded.at(1, 0).y, 3.984f, 2e-2f);
}

TEST(Environment, WhatIsNoPictureIsRefused) {
    const TemporaryFolder folder;
    writeBytes(folder.file("a.hdr"), {'n', 'o'});
    EXPECT_THROW(loadEnvironment(folder.file("a.hdr")), FileError);
    EXPECT_THROW(loadEnvironment(folder.file("missing.exr")), FileError);
}

}  // namespace
}  // namespace phat
