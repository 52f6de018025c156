#pragma once
// Pictures on disk.

#include <cstdint>
#include <string>
#include <vector>

#include "core/image.h"

namespace phat {

/// One float plane of a multi-channel EXR, [y][x].
struct Channel {
    std::string name;  // unprefixed: R, G, B, A, Y
    std::vector<float> values;
};

/// R,G,B, or Y in all three, of an OpenEXR file; half or float. Throws FileError.
Image readExr(const std::string& path);
/// All writers go through a temporary file beside the target that is renamed at the end. Throw FileError.
void writeExr(const std::string& path, const Image& image, bool halfFloat = false);
void writeExrChannels(const std::string& path, int width, int height, const std::vector<Channel>& channels);
/// Radiance .hdr (RGBE). Throws FileError.
Image readHdr(const std::string& path);
/// 8-bit sRGB picture of values in [0,1]; `image` is display-linear after tone mapping.
void writePng(const std::string& path, const Image& image);
/// Decodes PNG or JPEG to linear. Throws FileError.
Image readPng(const std::string& path);

}  // namespace phat
