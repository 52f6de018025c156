// PNG, JPEG and Radiance pictures through stb.

#include <fmt/format.h>
#include <stb_image_write.h>

#include <algorithm>
#include <cassert>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>

#include "core/base/srgb.h"
#include "io/base/atomic_file.h"
#include "io/base/file_error.h"
#include "io/base/plain_file.h"
#include "io/image/image_file.h"
#include "io/image/metered_stb.h"

namespace phat {
namespace {

using Pixels = std::unique_ptr<void, void (*)(void*)>;

// A file as stb reads it. stb takes a missing byte for 0: a cut Radiance file would never end (a run of
// length 0 is no progress) and a cut JPEG would pass, so bytes past the end are counted, and after
// `paddingBytes` of 255, which are no run of length 0, the stream does end.
struct PictureStream {
    std::FILE* file = nullptr;
    uint64_t paddingBytes = 0;
    bool readPastEnd = false;
};

int readStream(void* user, char* data, int size) {
    auto& stream = *static_cast<PictureStream*>(user);
    const size_t got = std::fread(data, 1, size_t(size), stream.file);
    if (got > 0) return int(got);
    stream.readPastEnd = true;
    const uint64_t padding = std::min(stream.paddingBytes, uint64_t(size));
    std::memset(data, 255, padding);
    stream.paddingBytes -= padding;
    return int(padding);
}

void skipStream(void* user, int count) {
    std::fseek(static_cast<PictureStream*>(user)->file, count, SEEK_CUR);
}

int streamEnded(void* user) {
    auto& stream = *static_cast<PictureStream*>(user);
    const int next = std::fgetc(stream.file);
    if (next == EOF) return 1;
    std::ungetc(next, stream.file);
    return 0;
}

constexpr stbi_io_callbacks kCallbacks{readStream, skipStream, streamEnded};

struct PictureFile {
    explicit PictureFile(const std::string& filePath) : path(filePath), file(nullptr, std::fclose) {
        requirePlainFile(path);
        file.reset(std::fopen(path.c_str(), "rb"));
        std::error_code error;
        bytes = std::filesystem::file_size(path, error);
        if (!file || error)
            throw FileError(path, fmt::format("cannot be read: {}",
                                              file ? error.message() : std::string(std::strerror(errno))));
        stream.file = file.get();
        allowDecoding(kHeaderAllowance);
    }

    // Sets the size, checked, and goes back to the start.
    void readSize() {
        if (!stbi_info_from_callbacks(&kCallbacks, &stream, &width, &height, &channels))
            throw FileError(path, fmt::format("is not a picture: {}", stbi_failure_reason()));
        const uint64_t pixels = uint64_t(width) * uint64_t(height);
        if (width <= 0 || height <= 0) throw FileError(path, "the picture is empty");
        if (pixels > kMaxPicturePixels)
            throw FileError(path, fmt::format("the picture is too large ({} x {} pixels)", width, height));
        rewind();
    }

    void rewind() {
        std::rewind(stream.file);
        stream.readPastEnd = false;
    }

    void check(const Pixels& pixels) const {
        if (stream.readPastEnd) throw FileError(path, "the picture is truncated");
        if (!pixels) throw FileError(path, fmt::format("the picture is broken: {}", stbi_failure_reason()));
    }

    void checkExpansion(uint64_t pixels, uint64_t pixelsPerByte) const {
        if (pixels > bytes * pixelsPerByte)
            throw FileError(path, fmt::format("the file is too short for {} x {} pixels", width, height));
    }

    std::string path;
    std::unique_ptr<std::FILE, int (*)(std::FILE*)> file;
    uint64_t bytes = 0;
    PictureStream stream;
    int width = 0;
    int height = 0;
    int channels = 0;
};

template <typename Sample>
Image decodeSrgb(const Sample* samples, int width, int height) {
    constexpr int kLevels = 1 << (8 * sizeof(Sample));
    std::vector<float> curve(kLevels);
    for (int i = 0; i < kLevels; ++i) curve[size_t(i)] = linearFromSrgb(float(i) / float(kLevels - 1));
    Image image(width, height);
    for (glm::vec3& pixel : image.pixels) {
        pixel = {curve[samples[0]], curve[samples[1]], curve[samples[2]]};
        samples += 3;
    }
    return image;
}

}  // namespace

Image readHdr(const std::string& path) {
    PictureFile file(path);
    if (!stbi_is_hdr_from_callbacks(&kCallbacks, &file.stream))
        throw FileError(path, "is not a Radiance picture");
    file.rewind();
    file.readSize();
    const uint64_t pixels = uint64_t(file.width) * uint64_t(file.height);
    file.checkExpansion(pixels, 16);  // two bytes hold a run of at most 127 of a pixel's four bytes
    file.stream.paddingBytes = 4 * pixels;
    allowDecoding(2 * sizeof(glm::vec4) * pixels + kHeaderAllowance);
    const Pixels values(
        stbi_loadf_from_callbacks(&kCallbacks, &file.stream, &file.width, &file.height, nullptr, 3),
        stbi_image_free);
    file.check(values);
    Image image(file.width, file.height);
    std::memcpy(image.pixels.data(), values.get(), pixels * sizeof(glm::vec3));
    return image;
}

Image readPng(const std::string& path) {
    PictureFile file(path);
    file.readSize();
    const bool wide = stbi_is_16_bit_from_callbacks(&kCallbacks, &file.stream);
    file.rewind();
    const bool jpeg = std::fgetc(file.stream.file) == 0xFF;
    file.rewind();
    const uint64_t pixels = uint64_t(file.width) * uint64_t(file.height);
    allowDecoding(decodingBytes({pixels, uint64_t(file.channels), wide, jpeg, file.bytes}));
    const Pixels values(
        wide ? static_cast<void*>(stbi_load_16_from_callbacks(&kCallbacks, &file.stream, &file.width,
                                                              &file.height, nullptr, 3))
             : stbi_load_from_callbacks(&kCallbacks, &file.stream, &file.width, &file.height, nullptr, 3),
        stbi_image_free);
    file.check(values);
    return wide ? decodeSrgb(static_cast<const uint16_t*>(values.get()), file.width, file.height)
                : decodeSrgb(static_cast<const uint8_t*>(values.get()), file.width, file.height);
}

namespace {

std::vector<uint8_t> srgbSamples(const Image& image) {
    std::vector<uint8_t> samples;
    samples.reserve(image.pixels.size() * 3);
    for (const glm::vec3& pixel : image.pixels)
        for (int i = 0; i < 3; ++i) {
            const float value = pixel[i] > 0 ? std::min(pixel[i], 1.0f) : 0.0f;  // the test is false for NaN
            samples.push_back(uint8_t(std::lround(255 * srgbFromLinear(value))));
        }
    return samples;
}

// Appends what an stb writer gives to the std::vector<uint8_t> at `user`.
void appendBytes(void* user, void* data, int size) {
    auto& all = *static_cast<std::vector<uint8_t>*>(user);
    all.insert(all.end(), static_cast<uint8_t*>(data), static_cast<uint8_t*>(data) + size);
}

// `encode`: calls an stb writer for `bytes` with the samples.
template <class Encode>
void writeEncoded(const std::string& path, const Image& image, const Encode& encode) {
    if (image.pixels.empty()) throw FileError(path, "an empty picture cannot be written");
    std::vector<uint8_t> bytes;
    if (!encode(&bytes, srgbSamples(image))) throw FileError(path, "the picture cannot be encoded");
    replaceFile(path, bytes);
}

}  // namespace

std::vector<uint8_t> pngBytes(int width, int height, const std::vector<glm::u8vec4>& pixels) {
    assert(!pixels.empty() && pixels.size() == size_t(width) * size_t(height));
    std::vector<uint8_t> bytes;
    if (!stbi_write_png_to_func(appendBytes, &bytes, width, height, 4, pixels.data(), 4 * width))
        throw std::runtime_error("a picture cannot be encoded");
    return bytes;
}

void writePng(const std::string& path, const Image& image) {
    writeEncoded(path, image, [&](void* bytes, const std::vector<uint8_t>& samples) {
        return stbi_write_png_to_func(appendBytes, bytes, image.width, image.height, 3, samples.data(),
                                      3 * image.width);
    });
}

void writeJpeg(const std::string& path, const Image& image) {
    constexpr int kQuality = 85;
    writeEncoded(path, image, [&](void* bytes, const std::vector<uint8_t>& samples) {
        return stbi_write_jpg_to_func(appendBytes, bytes, image.width, image.height, 3, samples.data(),
                                      kQuality);
    });
}

Image readPicture(const std::string& path) {
    unsigned char magic[4] = {};
    {
        const PictureFile file(path);
        if (std::fread(magic, 1, 4, file.stream.file) < 4)
            throw FileError(path, "the file is too short for a picture");
    }
    constexpr unsigned char kExr[4] = {0x76, 0x2f, 0x31, 0x01};
    if (std::memcmp(magic, kExr, 4) == 0) return readExr(path);
    return std::memcmp(magic, "#?", 2) == 0 ? readHdr(path) : readPng(path);
}

}  // namespace phat
