#include "io/gltf/gltf_images.h"

#include <fmt/core.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <map>
#include <memory>
#include <span>

#include "io/gltf/gltf_container.h"
#include "io/gltf/gltf_materials.h"

namespace {

// stb inflates whatever a PNG holds, however small the picture that it announces, so its allocations are
// metered. Blocks remember their size in front.
struct AllocationMeter {
    size_t left = 0;
};
thread_local AllocationMeter decodeMeter;
constexpr size_t kSizeSlot = 16;  // keeps malloc's alignment

void* meteredMalloc(size_t size) {
    if (size > decodeMeter.left) return nullptr;
    auto* block = static_cast<char*>(std::malloc(size + kSizeSlot));
    if (!block) return nullptr;
    decodeMeter.left -= size;
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
    decodeMeter.left += meteredSize(pointer);
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
#define STB_IMAGE_STATIC
#define STBI_ONLY_PNG
#define STBI_ONLY_JPEG
#define STBI_NO_STDIO
#define STBI_MAX_DIMENSIONS 16384
#define STBI_MALLOC(size) meteredMalloc(size)
#define STBI_REALLOC(pointer, size) meteredRealloc(pointer, size)
#define STBI_FREE(pointer) meteredFree(pointer)
#include <stb_image.h>

namespace phat::gltf {
namespace {

constexpr int kMaxSideTexels = 16384;
constexpr int64_t kMaxTexels = int64_t(1) << 28;
// A progressive JPEG visits every block once a scan; encoders write about ten. source: libjpeg-turbo's
// fuzzers stop at 500 for the same reason ("Two Issues with the JPEG Standard", 2015).
constexpr int kMaxJpegScans = 100;

struct StbFree {
    void operator()(stbi_uc* pixels) const { stbi_image_free(pixels); }
};

std::string nameOf(const ImageEntry& entry, size_t index) {
    if (!entry.name.empty()) return entry.name;
    if (!entry.uri.empty() && !entry.uri.starts_with("data:")) return entry.uri;
    return fmt::format("image {}", index);
}

bool isJpeg(std::span<const uint8_t> bytes) {
    return bytes.size() > 2 && bytes[0] == 0xFF && bytes[1] == 0xD8;
}

int countJpegScans(std::span<const uint8_t> bytes) {
    int scans = 0;
    for (size_t i = 0; i + 1 < bytes.size(); ++i) scans += bytes[i] == 0xFF && bytes[i + 1] == 0xDA;
    return scans;
}

// What stb holds at its worst moment, per texel. PNG: inflated rows, an interlace pass and the picture, or
// one of them beside the four channels made of it. JPEG: 16-bit coefficients (progressive) and samples of
// padded blocks, and the picture. Encoded PNG data are gathered in a buffer that grows by doubling.
uint64_t decodeBytes(std::span<const uint8_t> bytes, uint64_t texels, uint64_t channels) {
    constexpr uint64_t kSlack = 1 << 20;
    const uint64_t depth = stbi_is_16_bit_from_memory(bytes.data(), int(bytes.size())) ? 2 : 1;
    const uint64_t png = std::max({3 * channels * depth, (channels + 4) * depth, uint64_t(8)});
    return texels * (isJpeg(bytes) ? 4 * channels + 4 : png) + 4 * bytes.size() + kSlack;
}

// Throws Problem with the reason for the note; BudgetProblem stops the load.
struct BudgetProblem : Problem {
    using Problem::Problem;
};

TextureImage decode(std::span<const uint8_t> bytes, MemoryBudget& budget) {
    const auto* data = bytes.data();
    if (bytes.size() > size_t(INT32_MAX)) throw Problem("too large");
    const int size = int(bytes.size());
    TextureImage image;
    int channels = 0;
    decodeMeter.left = 1 << 20;  // for headers
    if (!stbi_info_from_memory(data, size, &image.width, &image.height, &channels)) {
        throw Problem("not a PNG or JPEG");
    }
    if (image.width <= 0 || image.height <= 0 || image.width > kMaxSideTexels ||
        image.height > kMaxSideTexels || int64_t(image.width) * image.height > kMaxTexels) {
        throw Problem(fmt::format("{}x{} texels are more than is supported", image.width, image.height));
    }
    if (isJpeg(bytes) && countJpegScans(bytes) > kMaxJpegScans) throw Problem("too many JPEG scans");

    const uint64_t texels = uint64_t(image.width) * uint64_t(image.height);
    const uint64_t workBytes = decodeBytes(bytes, texels, uint64_t(channels));
    try {
        budget.charge(workBytes, "its pictures");
    } catch (const Problem& problem) {
        throw BudgetProblem(problem.what());
    }
    decodeMeter.left = workBytes;
    const std::unique_ptr<stbi_uc, StbFree> pixels(
        stbi_load_from_memory(data, size, &image.width, &image.height, &channels, 4));
    if (pixels) {
        image.texels.resize(texels);
        std::memcpy(image.texels.data(), pixels.get(), texels * 4);
    }
    budget.release(workBytes - (pixels ? texels * 4 : 0));
    if (!pixels) throw Problem("cannot be decoded");
    return image;
}

TextureImage loadImage(const Document& document, const ImageEntry& entry, MemoryBudget& budget) {
    if (!entry.uri.empty()) {
        const std::vector<uint8_t> bytes = readUri(entry.uri, gltfFolder(document.source), budget.left());
        budget.allowFor(bytes.size());
        return decode(bytes, budget);
    }
    if (entry.bufferView < 0) throw Problem("has no data");
    const auto& view = document.model().bufferViews[size_t(entry.bufferView)];
    return decode(
        std::span(document.source.buffers[size_t(view.buffer)]).subspan(view.byteOffset, view.byteLength),
        budget);
}

}  // namespace

void loadImages(const Document& document, Scene& scene, MemoryBudget& budget, Notes& notes) {
    std::map<int32_t, int32_t> sceneImageOf;  // by index in the file; -1: cannot be had
    const auto sceneImage = [&](int32_t index) {
        const auto [it, isNew] = sceneImageOf.try_emplace(index, -1);
        if (!isNew) return it->second;
        const ImageEntry& entry = document.description.images[size_t(index)];
        try {
            TextureImage image = loadImage(document, entry, budget);
            image.name = nameOf(entry, size_t(index));
            scene.images.push_back(std::move(image));
            it->second = int32_t(scene.images.size() - 1);
        } catch (const BudgetProblem&) {
            throw;
        } catch (const Problem& problem) {
            notes.lines.push_back(fmt::format("image {} \"{}\" is left white: {}", index,
                                              shortUri(nameOf(entry, size_t(index))), problem.what()));
        }
        return it->second;
    };
    for (Material& material : scene.materials) {
        forEachSlot(material, [&](TextureSlot& slot) {
            if (slot.image < 0) return;
            slot.image = sceneImage(slot.image);
            if (slot.image < 0) slot = {};
        });
    }
}

}  // namespace phat::gltf
