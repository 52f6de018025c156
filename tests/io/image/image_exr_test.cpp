#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <ImfTiledOutputFile.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "core/base/random.h"
#include "io/base/file_error.h"
#include "io/image/image_file.h"
#include "support/temporary_folder.h"

namespace phat {
namespace {

Image noise(int width, int height) {
    Rng rng(3);
    Image image(width, height);
    for (glm::vec3& pixel : image.pixels)
        pixel = {100 * rng.uniform(), -rng.uniform(), std::exp(20 * rng.uniform() - 10)};
    return image;
}

std::string reasonOf(const std::string& path) {
    try {
        readExr(path);
        return "";
    } catch (const FileError& error) {
        EXPECT_EQ(error.path, path);
        EXPECT_EQ(error.reason.find('\n'), std::string::npos);
        return error.reason;
    }
}

// Writes planes through OpenEXR itself, where our own writers have no such option.
struct RawPlane {
    const char* name;
    const float* values;  // of `window`, row by row
    int sampling = 1;
};

void writeRaw(const std::string& path, Imath::Box2i window, const std::vector<RawPlane>& planes, bool tiled) {
    Imf::Header header(Imath::Box2i({0, 0}, {99, 99}), window);
    const size_t width = size_t(window.max.x - window.min.x + 1);
    Imf::FrameBuffer frameBuffer;
    for (const RawPlane& plane : planes) {
        const int s = plane.sampling;
        header.channels().insert(plane.name, Imf::Channel(Imf::FLOAT, s, s));
        frameBuffer.insert(plane.name,
                           Imf::Slice::Make(Imf::FLOAT, plane.values, window, 4, 4 * width / s, s, s));
    }
    if (tiled) {
        header.setTileDescription(Imf::TileDescription(16, 8));
        Imf::TiledOutputFile file(path.c_str(), header);
        file.setFrameBuffer(frameBuffer);
        file.writeTiles(0, file.numXTiles() - 1, 0, file.numYTiles() - 1);
    } else {
        Imf::OutputFile file(path.c_str(), header);
        file.setFrameBuffer(frameBuffer);
        file.writePixels(window.max.y - window.min.y + 1);
    }
}

std::vector<float> ramp(size_t count, float start) {
    std::vector<float> values(count);
    for (size_t i = 0; i < count; ++i) values[i] = start + float(i);
    return values;
}

TEST(ExrFile, FloatsComeBackBitForBit) {
    const TemporaryFolder folder;
    Image image = noise(37, 21);
    image.at(3, 4) = {std::numeric_limits<float>::infinity(), 1e-42f, 3e38f};
    writeExr(folder.file("a.exr"), image);
    const Image back = readExr(folder.file("a.exr"));
    ASSERT_EQ(back.width, 37);
    ASSERT_EQ(back.height, 21);
    EXPECT_EQ(back.pixels, image.pixels);
}

TEST(ExrFile, HalvesKeepElevenBitsAndClampTheFinite) {
    const TemporaryFolder folder;
    Image image = noise(37, 21);
    image.at(0, 0) = {1e9f, -1e9f, std::numeric_limits<float>::infinity()};
    writeExr(folder.file("a.exr"), image, true);
    const Image back = readExr(folder.file("a.exr"));
    EXPECT_EQ(back.at(0, 0).x, 65504.0f);
    EXPECT_EQ(back.at(0, 0).y, -65504.0f);
    EXPECT_TRUE(std::isinf(back.at(0, 0).z));
    for (size_t i = 1; i < image.pixels.size(); ++i)
        for (int c = 0; c < 3; ++c) {
            const float value = image.pixels[i][c];
            // Rounding to nearest: half a unit of the 11th bit, or half the smallest subnormal.
            ASSERT_LE(std::abs(back.pixels[i][c] - value), std::max(std::abs(value) * 0x1p-11f, 0x1p-25f));
        }
}

TEST(ExrFile, SameImageGivesSameBytes) {
    const TemporaryFolder folder;
    const Image image = noise(40, 40);
    writeExr(folder.file("a.exr"), image, true);
    writeExr(folder.file("b.exr"), image, true);
    EXPECT_EQ(readBytes(folder.file("a.exr")), readBytes(folder.file("b.exr")));
}

TEST(ExrFile, LuminanceGoesIntoAllChannels) {
    const TemporaryFolder folder;
    writeExrChannels(folder.file("y.exr"), 3, 2,
                     {{"Y", {1, 2, 3, 4, 5, 6}}, {"A", std::vector<float>(6, 0.5f)}});
    const Image back = readExr(folder.file("y.exr"));
    for (int i = 0; i < 6; ++i) EXPECT_EQ(back.pixels[size_t(i)], glm::vec3(float(i + 1)));
}

TEST(ExrFile, ReadsTilesAndWindowsAwayFromTheOrigin) {
    const TemporaryFolder folder;
    const Imath::Box2i window({-5, 40}, {27, 60});  // 33 x 21: neither side a multiple of the tiles'
    const auto red = ramp(33 * 21, 0), green = ramp(33 * 21, 1000), blue = ramp(33 * 21, 2000);
    for (const bool tiled : {false, true}) {
        writeRaw(folder.file("w.exr"), window, {{"R", red.data()}, {"G", green.data()}, {"B", blue.data()}},
                 tiled);
        const Image back = readExr(folder.file("w.exr"));
        ASSERT_EQ(back.width, 33);
        ASSERT_EQ(back.height, 21);
        for (size_t i = 0; i < back.pixels.size(); ++i)
            ASSERT_EQ(back.pixels[i], glm::vec3(red[i], green[i], blue[i]))
                << "tiled " << tiled << " at " << i;
    }
}

TEST(ExrFile, NamesTheChannelsThatItCannotUse) {
    const TemporaryFolder folder;
    const Imath::Box2i window({0, 0}, {7, 7});
    const auto values = ramp(64, 0);
    writeExrChannels(folder.file("p.exr"), 8, 8, {{"View.R", values}, {"View.G", values}});
    EXPECT_NE(reasonOf(folder.file("p.exr")).find("View.G, View.R"), std::string::npos);
    // Luminance with chroma at half resolution is a coloured picture: grey would be wrong.
    writeRaw(folder.file("c.exr"), window,
             {{"Y", values.data()}, {"RY", values.data(), 2}, {"BY", values.data(), 2}}, false);
    EXPECT_NE(reasonOf(folder.file("c.exr")).find("BY, RY, Y"), std::string::npos);
}

// Not one prefix of a file may pass for the picture, and none may crash.
TEST(ExrFile, EveryTruncationIsRefused) {
    const TemporaryFolder folder;
    writeExr(folder.file("a.exr"), noise(24, 40), true);
    const auto bytes = readBytes(folder.file("a.exr"));
    ASSERT_GT(bytes.size(), 1000u);
    for (size_t size = 0; size < bytes.size(); size += size < 600 ? 1 : 7) {
        writeBytes(folder.file("cut.exr"), {bytes.begin(), bytes.begin() + std::ptrdiff_t(size)});
        EXPECT_NE(reasonOf(folder.file("cut.exr")), "") << size << " of " << bytes.size();
    }
}

TEST(ExrFile, EveryFlippedHeaderByteIsReadOrRefused) {
    const TemporaryFolder folder;
    const Image image = noise(24, 40);
    writeExr(folder.file("a.exr"), image, true);
    const auto bytes = readBytes(folder.file("a.exr"));
    int refused = 0;
    for (size_t i = 0; i < 400; ++i)
        for (const int mask : {0x01, 0x80, 0xff}) {
            auto broken = bytes;
            broken[i] = char(broken[i] ^ mask);
            writeBytes(folder.file("flip.exr"), broken);
            refused += reasonOf(folder.file("flip.exr")) != "";
        }
    EXPECT_GT(refused, 300);
}

// The data window is the attribute's 16 bytes; a huge one must be refused by its size, not by running out.
TEST(ExrFile, HugeWindowsAreRefusedBeforeAllocation) {
    const TemporaryFolder folder;
    writeExr(folder.file("a.exr"), noise(24, 40));
    auto bytes = readBytes(folder.file("a.exr"));
    const std::string key("dataWindow\0box2i\0\x10\0\0\0", 21);
    const auto found = std::search(bytes.begin(), bytes.end(), key.begin(), key.end());
    ASSERT_NE(found, bytes.end());
    const auto setMax = [&](int32_t x, int32_t y) {
        const int32_t corner[2] = {x, y};
        std::memcpy(&*found + key.size() + 8, corner, 8);
        writeBytes(folder.file("huge.exr"), bytes);
    };
    setMax(8191, 8191);
    EXPECT_NE(reasonOf(folder.file("huge.exr")), "");
    setMax(1 << 20, 1 << 20);
    EXPECT_NE(reasonOf(folder.file("huge.exr")), "");
    setMax(-20, 39);
    EXPECT_NE(reasonOf(folder.file("huge.exr")), "");
}

TEST(ExrFile, MissingFileSaysSo) {
    EXPECT_NE(reasonOf("/nonexistent/picture.exr").find("no such file"), std::string::npos);
}

TEST(ExrFile, FailedWritesLeaveNothing) {
    const TemporaryFolder folder;
    EXPECT_THROW(writeExr(folder.file("no/such/folder.exr"), noise(4, 4)), FileError);
    EXPECT_THROW(writeExr(folder.path.string(), noise(4, 4)), FileError);
    EXPECT_THROW(writeExr(folder.file("empty.exr"), Image()), FileError);
    EXPECT_EQ(folder.fileCount(), 0u);
}

// OpenEXR would take a gigabyte, and fill it, for a file of some hundred bytes.
TEST(Exr, AttributesLongerThanTheFileAreRefused) {
    const TemporaryFolder folder;
    const std::string path = folder.file("a.exr");
    writeExr(path, noise(4, 4));
    std::vector<char> bytes = readBytes(path);
    const std::string attribute("note\0string\0", 12);
    const uint32_t size = 1 << 30;
    std::vector<char> added(attribute.begin(), attribute.end());
    added.insert(added.end(), reinterpret_cast<const char*>(&size), reinterpret_cast<const char*>(&size + 1));
    bytes.insert(bytes.begin() + 8, added.begin(), added.end());
    writeBytes(path, bytes);
    EXPECT_NE(reasonOf(path).find("an attribute is longer than the file"), std::string::npos)
        << reasonOf(path);
}

}  // namespace
}  // namespace phat
