#pragma once
// Pictures on disk.

#include <cstdint>
#include <string>
#include <vector>

#include "core/base/image.h"

namespace phat {

/// Larger pictures are refused before anything is allocated: a 16384x8192 sky.
inline constexpr uint64_t kMaxPicturePixels = uint64_t(1) << 27;

/// One float plane of a multi-channel EXR, [y][x].
struct Channel {
    std::string name;  // unprefixed: R, G, B, A, Y
    std::vector<float> values;
};

/// R,G,B, or Y in all three, of an OpenEXR file; half or float, scan lines or tiles, the first part of
/// several. The picture is the data window, wherever that lies. Throws FileError.
Image readExr(const std::string& path);
/// All writers go through a temporary file beside the target that is renamed at the end. Throw FileError.
/// Half floats: finite values are clamped to +-65504.
void writeExr(const std::string& path, const Image& image, bool halfFloat = false);
/// The bytes of such a file. Throws std::runtime_error.
std::vector<uint8_t> exrBytes(const Image& image, bool halfFloat = false);
/// pre: every channel has width * height values.
void writeExrChannels(const std::string& path, int width, int height, const std::vector<Channel>& channels);
/// Radiance .hdr (RGBE). Throws FileError.
Image readHdr(const std::string& path);
/// The bytes of an 8-bit RGBA picture, [y][x], row 0 on top, whose values are written as they are.
std::vector<uint8_t> pngBytes(int width, int height, const std::vector<glm::u8vec4>& pixels);
/// 8-bit sRGB picture of values in [0,1]; `image` is display-linear after tone mapping. Clamps; NaN is black.
void writePng(const std::string& path, const Image& image);
/// The same as JPEG, lossy: for images that are transferred.
void writeJpeg(const std::string& path, const Image& image);
/// Decodes PNG (8 or 16 bit) or JPEG to linear; alpha is dropped. Throws FileError.
Image readPng(const std::string& path);

/// Any of the above, by the file's first bytes. Throws FileError.
Image readPicture(const std::string& path);

}  // namespace phat
