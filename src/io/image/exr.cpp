// OpenEXR pictures.

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputPart.h>
#include <ImfMultiPartInputFile.h>
#include <ImfOutputFile.h>
#include <ImfStdIO.h>
#include <fmt/format.h>
#include <half.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "io/base/atomic_file.h"
#include "io/base/file_error.h"
#include "io/base/plain_file.h"
#include "io/image/image_file.h"

namespace phat {
namespace {

// Deflate expands at most 1032 times (zlib's technical notes), and the other lossless codecs less. The DWA
// codecs deflate one coefficient for 64 pixels at least.
constexpr uint64_t kMaxExpansion = 1032, kMaxDwaExpansion = 64 * kMaxExpansion;

std::string firstLine(const std::string& text) {
    return text.substr(0, text.find('\n'));
}

uint64_t bytesPerPixel(const Imf::ChannelList& channels) {
    uint64_t bytes = 0;
    for (auto c = channels.begin(); c != channels.end(); ++c) {
        const bool subsampled = c.channel().xSampling > 1 || c.channel().ySampling > 1;
        if (!subsampled) bytes += c.channel().type == Imf::HALF ? 2 : 4;
    }
    return bytes;
}

void checkSize(const std::string& path, const Imf::Header& header, uint64_t fileBytes) {
    const Imath::Box2i window = header.dataWindow();
    const int64_t width = int64_t(window.max.x) - window.min.x + 1;
    const int64_t height = int64_t(window.max.y) - window.min.y + 1;
    if (width <= 0 || height <= 0) throw FileError(path, "the picture is empty");
    const uint64_t pixels = uint64_t(width) * uint64_t(height);
    if (width > int64_t(kMaxPicturePixels) || height > int64_t(kMaxPicturePixels) ||
        pixels > kMaxPicturePixels)
        throw FileError(path, fmt::format("the picture is too large ({} x {} pixels)", width, height));
    const bool dwa =
        header.compression() == Imf::DWAA_COMPRESSION || header.compression() == Imf::DWAB_COMPRESSION;
    if (pixels * bytesPerPixel(header.channels()) > fileBytes * (dwa ? kMaxDwaExpansion : kMaxExpansion))
        throw FileError(path, fmt::format("the file is too short for {} x {} pixels", width, height));
}

bool readable(const Imf::ChannelList& channels, const char* name) {
    const Imf::Channel* channel = channels.findChannel(name);
    return channel && channel->xSampling == 1 && channel->ySampling == 1;
}

std::string channelNames(const Imf::ChannelList& channels) {
    std::string names;
    for (auto c = channels.begin(); c != channels.end(); ++c)
        names += (names.empty() ? "" : ", ") + std::string(c.name());
    return names;
}

// The file's channel for each of red, green, blue.
std::array<const char*, 3> chooseChannels(const std::string& path, const Imf::ChannelList& channels) {
    if (readable(channels, "R") && readable(channels, "G") && readable(channels, "B")) return {"R", "G", "B"};
    // With RY and BY beside it, Y is the luminance of a coloured picture stored as chroma.
    if (readable(channels, "Y") && !channels.findChannel("RY") && !channels.findChannel("BY"))
        return {"Y", "Y", "Y"};
    throw FileError(path, fmt::format("has neither channels R, G, B nor Y at full resolution (it has {})",
                                      channelNames(channels)));
}

// OpenEXR takes memory for an attribute before it knows whether the file has as much. What else is wrong it
// says itself.
void checkAttributes(const std::string& path, uint64_t fileBytes) {
    constexpr uint32_t kSeveralParts =
        0x1000;  // in the second word; a header without attributes ends their headers
    std::ifstream file(path, std::ios::binary);
    std::array<uint32_t, 2> start{};
    file.read(reinterpret_cast<char*>(start.data()), sizeof(start));
    bool headerBegins = true;
    for (std::string name, type; std::getline(file, name, '\0');) {
        if (name.empty()) {
            if (headerBegins || !(start[1] & kSeveralParts)) return;
            headerBegins = true;
            continue;
        }
        headerBegins = false;
        uint32_t size = 0;
        std::getline(file, type, '\0');
        if (!file.read(reinterpret_cast<char*>(&size), sizeof(size))) return;
        if (size > fileBytes - uint64_t(file.tellg()))
            throw FileError(path, "is not a complete OpenEXR picture: an attribute is longer than the file");
        file.seekg(size, std::ios::cur);
    }
}

Image readFirstPart(const std::string& path, uint64_t fileBytes) {
    checkAttributes(path, fileBytes);
    // This class reads the headers without allocating for the pixels, so that the size can be checked first.
    Imf::MultiPartInputFile file(path.c_str());
    const Imf::Header& header = file.header(0);
    checkSize(path, header, fileBytes);
    const auto names = chooseChannels(path, header.channels());
    Imf::InputPart part(file, 0);  // refuses what is broken before there is a picture

    const Imath::Box2i window = header.dataWindow();
    Image image(window.max.x - window.min.x + 1, window.max.y - window.min.y + 1);
    const size_t xStride = sizeof(glm::vec3), yStride = xStride * size_t(image.width);
    Imf::FrameBuffer frameBuffer;
    const int count = std::string(names[0]) == "Y" ? 1 : 3;
    for (int i = 0; i < count; ++i)
        frameBuffer.insert(names[i],
                           Imf::Slice::Make(Imf::FLOAT, &image.pixels[0][i], window, xStride, yStride));
    part.setFrameBuffer(frameBuffer);
    part.readPixels(window.min.y, window.max.y);
    if (count == 1)
        for (glm::vec3& pixel : image.pixels) pixel = glm::vec3(pixel.x);
    return image;
}

float clampToHalf(float value) {
    return std::isfinite(value) ? std::clamp(value, -65504.0f, 65504.0f) : value;
}

// One plane of a picture that is written, with the space between its pixels in bytes.
struct Plane {
    std::string name;
    Imf::PixelType type;
    const void* values;
    size_t stride;
};

std::vector<uint8_t> planeBytes(int width, int height, const std::vector<Plane>& planes) {
    if (width <= 0 || height <= 0) throw std::runtime_error("an empty picture cannot be written");
    Imf::Header header(width, height);
    header.compression() = Imf::ZIP_COMPRESSION;
    Imf::FrameBuffer frameBuffer;
    for (const Plane& plane : planes) {
        header.channels().insert(plane.name, Imf::Channel(plane.type));
        frameBuffer.insert(plane.name, Imf::Slice::Make(plane.type, plane.values, header.dataWindow(),
                                                        plane.stride, plane.stride * size_t(width)));
    }
    // In memory first: OpenEXR does not look whether the last bytes of a file could be written.
    try {
        Imf::StdOSStream stream;
        {
            Imf::OutputFile file(stream, header);
            file.setFrameBuffer(frameBuffer);
            file.writePixels(height);
        }
        const std::string bytes = stream.str();
        return {bytes.begin(), bytes.end()};
    } catch (const std::bad_alloc&) {
        throw;
    } catch (const std::exception& error) {
        throw std::runtime_error("cannot be encoded: " + firstLine(error.what()));
    }
}

// `encode` returns the bytes, or throws std::runtime_error.
template <class Encode>
void writeEncoded(const std::string& path, const Encode& encode) {
    std::vector<uint8_t> bytes;
    try {
        bytes = encode();
    } catch (const std::runtime_error& error) {
        throw FileError(path, error.what());
    }
    replaceFile(path, bytes);
}

}  // namespace

Image readExr(const std::string& path) {
    requirePlainFile(path);
    std::error_code error;
    const uint64_t fileBytes = std::filesystem::file_size(path, error);
    if (error) throw FileError(path, "cannot be read: " + error.message());
    try {
        return readFirstPart(path, fileBytes);
    } catch (const FileError&) {
        throw;
    } catch (const std::bad_alloc&) {
        throw;
    } catch (const std::exception& broken) {
        throw FileError(path, "is not a complete OpenEXR picture: " + firstLine(broken.what()));
    }
}

std::vector<uint8_t> exrBytes(const Image& image, bool halfFloat) {
    assert(image.pixels.size() == size_t(image.width) * image.height);
    constexpr const char* kNames[] = {"R", "G", "B"};
    std::vector<Plane> planes;
    std::vector<Imath::half> halves;
    if (halfFloat) {
        halves.reserve(image.pixels.size() * 3);
        for (const glm::vec3& pixel : image.pixels)
            for (int i = 0; i < 3; ++i) halves.push_back(Imath::half(clampToHalf(pixel[i])));
    }
    for (int i = 0; i < 3 && !image.pixels.empty(); ++i) {
        if (halfFloat)
            planes.push_back({kNames[i], Imf::HALF, halves.data() + i, 3 * sizeof(Imath::half)});
        else
            planes.push_back({kNames[i], Imf::FLOAT, &image.pixels[0][i], sizeof(glm::vec3)});
    }
    return planeBytes(image.width, image.height, planes);
}

void writeExr(const std::string& path, const Image& image, bool halfFloat) {
    writeEncoded(path, [&] { return exrBytes(image, halfFloat); });
}

void writeExrChannels(const std::string& path, int width, int height, const std::vector<Channel>& channels) {
    std::vector<Plane> planes;
    for (const Channel& channel : channels) {
        assert(channel.values.size() == size_t(width) * height);
        planes.push_back({channel.name, Imf::FLOAT, channel.values.data(), sizeof(float)});
    }
    writeEncoded(path, [&] { return planeBytes(width, height, planes); });
}

}  // namespace phat
