#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "io/base/file_error.h"
#include "io/image/image_file.h"
#include "support/temporary_folder.h"

namespace phat {
namespace {

// Independent of the implementation's float code.
double encoded(double linear) {
    return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
}

std::vector<char> bytesOf(const std::string& text) {
    return {text.begin(), text.end()};
}

TEST(PngFile, RoundsToTheNearestEncodedLevel) {
    const TemporaryFolder folder;
    constexpr int kSize = 4096;
    Image image(kSize, 1);
    for (int x = 0; x < kSize; ++x) image.at(x, 0) = glm::vec3(float(x) / (kSize - 1), 0.5f, 1);
    writePng(folder.file("a.png"), image);
    const Image back = readPng(folder.file("a.png"));
    ASSERT_EQ(back.width, kSize);
    ASSERT_EQ(back.height, 1);
    for (int x = 0; x < kSize; ++x) {
        ASSERT_NEAR(encoded(back.at(x, 0).x), encoded(image.at(x, 0).x), 0.5 / 255 + 1e-5) << x;
        ASSERT_EQ(back.at(x, 0).z, 1.0f);
    }
}

TEST(PngFile, SecondTripChangesNothing) {
    const TemporaryFolder folder;
    Image image(16, 16);
    for (int i = 0; i < 256; ++i) image.pixels[size_t(i)] = glm::vec3(float(i) / 255);
    writePng(folder.file("a.png"), image);
    const Image once = readPng(folder.file("a.png"));
    writePng(folder.file("b.png"), once);
    EXPECT_EQ(readPng(folder.file("b.png")).pixels, once.pixels);
    EXPECT_EQ(readBytes(folder.file("a.png")), readBytes(folder.file("b.png")));
}

TEST(PngFile, ClampsAndPaintsNanBlack) {
    const TemporaryFolder folder;
    Image image(2, 1);
    image.at(0, 0) = {-1, 7, std::numeric_limits<float>::quiet_NaN()};
    image.at(1, 0) = glm::vec3(std::numeric_limits<float>::infinity());
    writePng(folder.file("a.png"), image);
    const Image back = readPng(folder.file("a.png"));
    EXPECT_EQ(back.at(0, 0), glm::vec3(0, 1, 0));
    EXPECT_EQ(back.at(1, 0), glm::vec3(1));
}

TEST(PngFile, EveryTruncationIsRefused) {
    const TemporaryFolder folder;
    Image image(9, 9, glm::vec3(0.3f, 0.2f, 0.7f));
    image.at(4, 4) = glm::vec3(1);
    writePng(folder.file("a.png"), image);
    const auto bytes = readBytes(folder.file("a.png"));
    // The last chunk is 12 bytes without content: a picture that lacks only its checksum is still whole.
    for (size_t size = 0; size + 4 < bytes.size(); ++size) {
        writeBytes(folder.file("cut.png"), {bytes.begin(), bytes.begin() + std::ptrdiff_t(size)});
        EXPECT_THROW(readPng(folder.file("cut.png")), FileError) << size;
    }
}

TEST(PngFile, HugeSizesAreRefusedBeforeAllocation) {
    const TemporaryFolder folder;
    writePng(folder.file("a.png"), Image(4, 4));
    auto bytes = readBytes(folder.file("a.png"));
    bytes[18] = bytes[22] = 0x2e;  // 12000 x 12000
    bytes[19] = bytes[23] = char(0xe0);
    writeBytes(folder.file("huge.png"), bytes);
    try {
        readPng(folder.file("huge.png"));
        FAIL();
    } catch (const FileError& error) {
        EXPECT_NE(error.reason.find("too large"), std::string::npos) << error.reason;
    }
}

// RGBE: value = mantissa / 256 * 2^(exponent - 128). Wide enough rows are run-length coded, 8 here.
const std::string kHdrHeader = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 8\n";
const std::string kHdrRow(
    "\2\2\0\10"
    "\x88\x80"
    "\x88\x40"
    "\x88\0"
    "\x88\x82",
    12);

TEST(HdrFile, DecodesRunLengths) {
    const TemporaryFolder folder;
    writeBytes(folder.file("a.hdr"), bytesOf(kHdrHeader + kHdrRow + kHdrRow));
    const Image image = readHdr(folder.file("a.hdr"));
    ASSERT_EQ(image.width, 8);
    ASSERT_EQ(image.height, 2);
    for (const glm::vec3& pixel : image.pixels) EXPECT_EQ(pixel, glm::vec3(2, 1, 0));
}

TEST(HdrFile, EveryTruncationIsRefusedAndEnds) {
    const TemporaryFolder folder;
    const auto bytes = bytesOf(kHdrHeader + kHdrRow + kHdrRow);
    for (size_t size = 0; size < bytes.size(); ++size) {
        writeBytes(folder.file("cut.hdr"), {bytes.begin(), bytes.begin() + std::ptrdiff_t(size)});
        EXPECT_THROW(readHdr(folder.file("cut.hdr")), FileError) << size;
    }
}

// A run of length 0 is no progress: followed by the end of the file it must not be waited for.
TEST(HdrFile, EmptyRunsEnd) {
    const TemporaryFolder folder;
    writeBytes(folder.file("zero.hdr"), bytesOf(kHdrHeader + kHdrRow.substr(0, 4) + std::string(40, '\0')));
    EXPECT_THROW(readHdr(folder.file("zero.hdr")), FileError);
}

TEST(HdrFile, HugeSizesAreRefusedBeforeAllocation) {
    const TemporaryFolder folder;
    writeBytes(folder.file("a.hdr"),
               bytesOf("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 8000 +X 8000\n" + kHdrRow));
    EXPECT_THROW(readHdr(folder.file("a.hdr")), FileError);
}

TEST(Picture, IsRecognisedByItsFirstBytes) {
    const TemporaryFolder folder;
    writeBytes(folder.file("hdr"), bytesOf(kHdrHeader + kHdrRow + kHdrRow));
    writeExr(folder.file("exr"), Image(3, 1, glm::vec3(5)));
    writePng(folder.file("png"), Image(4, 1, glm::vec3(1)));
    writeBytes(folder.file("text"), bytesOf("hello, this is no picture"));
    EXPECT_EQ(readPicture(folder.file("hdr")).width, 8);
    EXPECT_EQ(readPicture(folder.file("exr")).pixels[0], glm::vec3(5));
    EXPECT_EQ(readPicture(folder.file("png")).width, 4);
    EXPECT_THROW(readPicture(folder.file("text")), FileError);
    EXPECT_THROW(readPicture(folder.file("missing")), FileError);
    EXPECT_THROW(readPicture(folder.path.string()), FileError);
}

}  // namespace
}  // namespace phat
