#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/parallel.h"
#include "core/base/srgb.h"
#include "core/scene/footprint.h"

namespace phat {
namespace {

constexpr int kCodes = 4096;  // of the square root of a linear value, in which sRGB is nearly straight

struct SrgbTables {
    std::array<float, 256> linear;
    std::array<uint8_t, kCodes + 1> encoded;

    SrgbTables() {
        for (int i = 0; i < 256; ++i) linear[size_t(i)] = linearFromSrgb(float(i) / 255.0f);
        for (int i = 0; i <= kCodes; ++i) {
            const float l = square(float(i) / float(kCodes));
            encoded[size_t(i)] = uint8_t(255.0f * srgbFromLinear(l) + 0.5f);
        }
    }
    uint8_t encode(float l) const { return encoded[size_t(std::sqrt(l) * float(kCodes) + 0.5f)]; }
};

const SrgbTables& srgbTables() {
    static const SrgbTables tables;
    return tables;
}

// The texels of the finer level under texel `i` of `half`: two of them, three at the end of an odd number.
std::pair<int, int> texelsUnder(int i, int half, int full) {
    return {std::min(2 * i, full - 1), i == half - 1 ? full : 2 * i + 2};
}

glm::u8vec4 meanOf(const TextureImage& image, std::pair<int, int> columns, std::pair<int, int> rows,
                   bool srgb) {
    const SrgbTables& tables = srgbTables();
    glm::vec4 sum(0);
    for (int y = rows.first; y < rows.second; ++y)
        for (int x = columns.first; x < columns.second; ++x) {
            const glm::u8vec4 t = image.texels[size_t(y) * size_t(image.width) + size_t(x)];
            sum += srgb ? glm::vec4(tables.linear[t.r], tables.linear[t.g], tables.linear[t.b], t.a)
                        : glm::vec4(t);
        }
    sum /= float((columns.second - columns.first) * (rows.second - rows.first));
    const auto rounded = [](float v) { return uint8_t(v + 0.5f); };
    if (srgb) return {tables.encode(sum.r), tables.encode(sum.g), tables.encode(sum.b), rounded(sum.a)};
    return {rounded(sum.r), rounded(sum.g), rounded(sum.b), rounded(sum.a)};
}

TextureImage halved(const TextureImage& image, bool srgb) {
    TextureImage half;
    half.width = std::max(image.width / 2, 1);
    half.height = std::max(image.height / 2, 1);
    half.texels.resize(size_t(half.width) * size_t(half.height));
    SilentProgress silent;
    parallelRanges(size_t(half.height), 16, silent, [&](size_t begin, size_t end) {
        for (size_t y = begin; y < end; ++y)
            for (int x = 0; x < half.width; ++x)
                half.texels[y * size_t(half.width) + size_t(x)] =
                    meanOf(image, texelsUnder(x, half.width, image.width),
                           texelsUnder(int(y), half.height, image.height), srgb);
    });
    return half;
}

std::vector<TextureImage> levelsOf(const TextureImage& image, bool srgb) {
    std::vector<TextureImage> levels;
    if (image.texels.empty()) return levels;
    for (int side = std::max(image.width, image.height); side > 1; side /= 2) {
        TextureImage half = halved(levels.empty() ? image : levels.back(), srgb);
        levels.push_back(std::move(half));
    }
    return levels;
}

}  // namespace

TextureLevels::TextureLevels(const Scene& scene) {
    const auto use = [&](const TextureSlot& slot, bool srgb) {
        if (slot.image < 0) return;
        levels_.resize(2 * scene.images.size());
        std::vector<TextureImage>& levels = levels_[2 * size_t(slot.image) + size_t(srgb)];
        if (levels.empty()) levels = levelsOf(scene.images[size_t(slot.image)], srgb);
    };
    for (const Material& m : scene.materials) {
        for (const TextureSlot* color : {&m.baseColorTexture, &m.emissionTexture, &m.specularColorTexture})
            use(*color, true);
        for (const TextureSlot* value :
             {&m.metallicRoughnessTexture, &m.specularTexture, &m.normalTexture, &m.clearcoatTexture,
              &m.clearcoatRoughnessTexture, &m.clearcoatNormalTexture, &m.transmissionTexture})
            use(*value, false);
    }
}

const TextureImage& TextureLevels::at(const Scene& scene, int32_t image, bool srgb, int level) const {
    const size_t index = 2 * size_t(image) + size_t(srgb);
    if (level <= 0 || index >= levels_.size() || levels_[index].empty()) return scene.images[size_t(image)];
    return levels_[index][size_t(std::min(level, int(levels_[index].size()))) - 1];
}

}  // namespace phat
