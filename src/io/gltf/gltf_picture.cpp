#include "io/gltf/gltf_picture.h"

#include <avif/avif.h>
#include <fmt/core.h>
#include <webp/decode.h>

#include <cstring>
#include <memory>
#include <string_view>

#include "io/image/metered_stb.h"

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

void checkSize(int64_t width, int64_t height) {
    if (width <= 0 || height <= 0 || width > kMaxSideTexels || height > kMaxSideTexels ||
        width * height > kMaxTexels)
        throw Problem(fmt::format("{}x{} texels are more than is supported", width, height));
}

void chargePicture(uint64_t bytes, MemoryBudget& budget) {
    try {
        budget.charge(bytes, "its pictures");
    } catch (const Problem& problem) {
        throw BudgetProblem(problem.what());
    }
}

bool isJpeg(std::span<const uint8_t> bytes) {
    return bytes.size() > 2 && bytes[0] == 0xFF && bytes[1] == 0xD8;
}

int countJpegScans(std::span<const uint8_t> bytes) {
    int scans = 0;
    for (size_t i = 0; i + 1 < bytes.size(); ++i) scans += bytes[i] == 0xFF && bytes[i + 1] == 0xDA;
    return scans;
}

TextureImage decodeByStb(std::span<const uint8_t> bytes, MemoryBudget& budget) {
    const auto* data = bytes.data();
    if (bytes.size() > size_t(INT32_MAX)) throw Problem("too large");
    const int size = int(bytes.size());
    TextureImage image;
    int channels = 0;
    allowDecoding(kHeaderAllowance);
    if (!stbi_info_from_memory(data, size, &image.width, &image.height, &channels)) {
        throw Problem("not a PNG, JPEG, WebP or AVIF");
    }
    checkSize(image.width, image.height);
    if (isJpeg(bytes) && countJpegScans(bytes) > kMaxJpegScans) throw Problem("too many JPEG scans");

    const uint64_t texels = uint64_t(image.width) * uint64_t(image.height);
    const bool wide = stbi_is_16_bit_from_memory(data, size);
    const uint64_t workBytes = decodingBytes({texels, uint64_t(channels), wide, isJpeg(bytes), bytes.size()});
    chargePicture(workBytes, budget);
    allowDecoding(workBytes);
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

// Working memory is given back when the picture is decoded; what stays are four bytes a texel.
class WorkCharge {
  public:
    WorkCharge(uint64_t bytes, MemoryBudget& budget) : bytes_(bytes), budget_(budget) {
        chargePicture(bytes, budget);
    }
    ~WorkCharge() { budget_.release(bytes_); }
    WorkCharge(const WorkCharge&) = delete;
    WorkCharge& operator=(const WorkCharge&) = delete;

  private:
    uint64_t bytes_;
    MemoryBudget& budget_;
};

TextureImage emptyImage(int64_t width, int64_t height, MemoryBudget& budget) {
    chargePicture(uint64_t(width * height) * 4, budget);
    TextureImage image;
    image.width = int(width);
    image.height = int(height);
    image.texels.resize(size_t(width * height));
    return image;
}

TextureImage decodeWebp(std::span<const uint8_t> bytes, MemoryBudget& budget) {
    WebPBitstreamFeatures features;
    if (WebPGetFeatures(bytes.data(), bytes.size(), &features) != VP8_STATUS_OK)
        throw Problem("is a damaged WebP");
    if (features.has_animation) throw Problem("is an animated WebP");
    checkSize(features.width, features.height);
    // Lossless: the picture and its transforms; lossy: rows of YUV and a plane of alpha.
    constexpr uint64_t kTexelBytes = 10, kSlack = 1 << 20;
    const uint64_t texels = uint64_t(features.width) * uint64_t(features.height);
    const WorkCharge work(texels * kTexelBytes + kSlack, budget);
    TextureImage image = emptyImage(features.width, features.height, budget);
    if (!WebPDecodeRGBAInto(bytes.data(), bytes.size(), reinterpret_cast<uint8_t*>(image.texels.data()),
                            image.texels.size() * 4, features.width * 4)) {
        budget.release(texels * 4);
        throw Problem("is a damaged WebP");
    }
    return image;
}

using AvifDecoder = std::unique_ptr<avifDecoder, void (*)(avifDecoder*)>;

// `mostTexels` also holds for the codec's frames, whose size the container need not tell truly.
AvifDecoder parsedAvif(std::span<const uint8_t> bytes, int64_t mostTexels) {
    AvifDecoder decoder(avifDecoderCreate(), avifDecoderDestroy);
    decoder->imageSizeLimit = uint32_t(mostTexels);
    decoder->imageCountLimit = 1;
    decoder->maxThreads = 1;
    if (avifDecoderSetIOMemory(decoder.get(), bytes.data(), bytes.size()) != AVIF_RESULT_OK ||
        avifDecoderParse(decoder.get()) != AVIF_RESULT_OK)
        throw Problem("is a damaged AVIF");
    return decoder;
}

TextureImage decodeAvif(std::span<const uint8_t> bytes, MemoryBudget& budget) {
    const AvifDecoder sized = parsedAvif(bytes, kMaxTexels);
    const int64_t width = sized->image->width, height = sized->image->height;
    checkSize(width, height);
    // Planes of up to 16 bits with alpha, those of the reference frames, and the filters' copies.
    constexpr uint64_t kTexelBytes = 32, kSlack = 8 << 20;
    const WorkCharge work(uint64_t(width * height) * kTexelBytes + kSlack, budget);
    const AvifDecoder decoder = parsedAvif(bytes, width * height);
    if (avifDecoderNextImage(decoder.get()) != AVIF_RESULT_OK || decoder->image->width != uint32_t(width) ||
        decoder->image->height != uint32_t(height))
        throw Problem("is a damaged AVIF");
    TextureImage image = emptyImage(width, height, budget);
    avifRGBImage rgb;
    avifRGBImageSetDefaults(&rgb, decoder->image);
    rgb.format = AVIF_RGB_FORMAT_RGBA;
    rgb.depth = 8;
    rgb.pixels = reinterpret_cast<uint8_t*>(image.texels.data());
    rgb.rowBytes = uint32_t(width * 4);
    if (avifImageYUVToRGB(decoder->image, &rgb) != AVIF_RESULT_OK) {
        budget.release(image.texels.size() * 4);
        throw Problem("is a damaged AVIF");
    }
    return image;
}

}  // namespace

std::string_view pictureType(std::span<const uint8_t> bytes) {
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    if (text.starts_with("\x89PNG")) return "image/png";
    if (text.starts_with("\xff\xd8\xff")) return "image/jpeg";
    if (text.starts_with("RIFF") && text.substr(0, 12).ends_with("WEBP")) return "image/webp";
    if (text.starts_with("\xabKTX 20")) return "image/ktx2";
    if (text.size() > 12 && (text.substr(4, 8) == "ftypavif" || text.substr(4, 8) == "ftypmif1"))
        return "image/avif";
    return "";
}

TextureImage decodePicture(std::span<const uint8_t> bytes, MemoryBudget& budget) {
    const std::string_view type = pictureType(bytes);
    if (type == "image/webp") return decodeWebp(bytes, budget);
    if (type == "image/avif") return decodeAvif(bytes, budget);
    if (type == "image/ktx2") throw Problem("is a KTX2 picture, which is not supported");
    if (type != "image/png" && type != "image/jpeg") throw Problem("not a PNG, JPEG, WebP or AVIF");
    return decodeByStb(bytes, budget);
}

}  // namespace phat::gltf
