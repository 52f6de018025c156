#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>

namespace {

thread_local size_t bytesLeft = 0;
constexpr size_t kSizeSlot = 16;  // keeps malloc's alignment; blocks remember their size in front

void* meteredMalloc(size_t size) {
    if (size > bytesLeft) return nullptr;
    auto* block = static_cast<char*>(std::malloc(size + kSizeSlot));
    if (!block) return nullptr;
    bytesLeft -= size;
    std::memcpy(block, &size, sizeof size);
    return block + kSizeSlot;
}

size_t meteredSize(const void* pointer) {
    size_t size;
    std::memcpy(&size, static_cast<const char*>(pointer) - kSizeSlot, sizeof size);
    return size;
}

void meteredFree(void* pointer) {
    if (!pointer) return;
    bytesLeft += meteredSize(pointer);
    std::free(static_cast<char*>(pointer) - kSizeSlot);
}

void* meteredRealloc(void* pointer, size_t size) {
    void* grown = meteredMalloc(size);
    if (grown && pointer) std::memcpy(grown, pointer, std::min(size, meteredSize(pointer)));
    if (grown) meteredFree(pointer);
    return grown;
}

}  // namespace

#define STB_IMAGE_IMPLEMENTATION
#define STBI_ONLY_PNG
#define STBI_ONLY_JPEG
#define STBI_ONLY_HDR
#define STBI_NO_STDIO
#define STBI_MALLOC(size) meteredMalloc(size)
#define STBI_REALLOC(pointer, size) meteredRealloc(pointer, size)
#define STBI_FREE(pointer) meteredFree(pointer)
#include "io/image/metered_stb.h"

namespace phat {

void allowDecoding(uint64_t bytes) {
    bytesLeft = bytes;
}

// PNG: inflated rows, an interlace pass and the picture, or one of them beside the four channels made of it.
// JPEG: 16-bit coefficients (progressive) and samples of padded blocks, and the picture. Encoded PNG data are
// gathered in a buffer that grows by doubling.
uint64_t decodingBytes(const EncodedPicture& picture) {
    constexpr uint64_t kSlack = 1 << 20;
    const uint64_t channels = picture.channels, depth = picture.wide ? 2 : 1;
    const uint64_t png = std::max({3 * channels * depth, (channels + 4) * depth, uint64_t(8)});
    return picture.texels * (picture.jpeg ? 4 * channels + 4 : png) + 4 * picture.fileBytes + kSlack;
}

}  // namespace phat
