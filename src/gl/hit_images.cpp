#include "gl/hit_images.h"

#include <algorithm>
#include <bit>

#include "core/base/parallel.h"
#include "core/scene/shading.h"
#include "gl/textures.h"

namespace phat {
namespace {

constexpr uint32_t kMaxSide = 1024;

bool isPicture(const Scene& scene, int32_t image) {
    return image >= 0 && !scene.images[size_t(image)]->texels.empty();
}

void addLayer(const Scene& scene, const TextureSlot& slot, std::map<int32_t, uint32_t>& layers) {
    if (!isPicture(scene, slot.image) || layers.size() >= kNoLayer) return;
    layers.emplace(slot.image, uint32_t(layers.size()));
}

uint32_t sideOf(const Scene& scene, const std::map<int32_t, uint32_t>& layers) {
    uint32_t largest = 1;
    for (const auto& [image, layer] : layers) {
        const TextureImage& picture = *scene.images[size_t(image)];
        largest = std::max(largest, uint32_t(std::max(picture.width, picture.height)));
    }
    uint32_t side = std::min(std::bit_ceil(largest), kMaxSide);
    // A third more for the mipmaps.
    while (side > 1 && uint64_t(side) * side * 4 * 4 / 3 * layers.size() > kMaxHitImageBytes) side /= 2;
    return side;
}

// The mean of the texels under each of side x side cells; where the picture has fewer, the nearest one.
std::vector<glm::u8vec4> resized(const TextureImage& picture, uint32_t side) {
    std::vector<glm::u8vec4> texels(size_t(side) * side);
    const auto range = [&](uint32_t cell, int size) {
        const int begin = int(uint64_t(cell) * uint64_t(size) / side);
        return std::pair(begin, std::max(int(uint64_t(cell + 1) * uint64_t(size) / side), begin + 1));
    };
    for (uint32_t y = 0; y < side; ++y) {
        const auto [y0, y1] = range(y, picture.height);
        for (uint32_t x = 0; x < side; ++x) {
            const auto [x0, x1] = range(x, picture.width);
            glm::uvec4 sum(0);
            for (int v = y0; v < y1; ++v)
                for (int u = x0; u < x1; ++u)
                    sum += glm::uvec4(picture.texels[size_t(v) * size_t(picture.width) + size_t(u)]);
            texels[size_t(y) * side + x] = glm::u8vec4(sum / uint32_t((x1 - x0) * (y1 - y0)));
        }
    }
    return texels;
}

GlTexture uploadLayers(const Scene& scene, const std::map<int32_t, uint32_t>& layers, GLenum format) {
    const uint32_t side = sideOf(scene, layers);
    GlTexture array =
        createTextureArray(format, glm::uvec2(side), std::max(int(layers.size()), 1), std::bit_width(side));
    for (const auto& [image, layer] : layers)
        glTextureSubImage3D(array.name(), 0, 0, 0, GLint(layer), GLsizei(side), GLsizei(side), 1, GL_RGBA,
                            GL_UNSIGNED_BYTE, resized(*scene.images[size_t(image)], side).data());
    glGenerateTextureMipmap(array.name());
    glTextureParameteri(array.name(), GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
    glTextureParameteri(array.name(), GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    glTextureParameteri(array.name(), GL_TEXTURE_WRAP_S, GL_REPEAT);
    glTextureParameteri(array.name(), GL_TEXTURE_WRAP_T, GL_REPEAT);
    return array;
}

}  // namespace

HitImages uploadHitImages(const Scene& scene) {
    HitImages images;
    for (const Material& material : scene.materials) {
        addLayer(scene, material.baseColorTexture, images.colorLayers);
        addLayer(scene, material.emissionTexture, images.colorLayers);
        addLayer(scene, material.metallicRoughnessTexture, images.linearLayers);
        addLayer(scene, material.normalTexture, images.linearLayers);
    }
    images.colors = uploadLayers(scene, images.colorLayers, GL_SRGB8_ALPHA8);
    images.linear = uploadLayers(scene, images.linearLayers, GL_RGBA8);
    checkGl("uploading the pictures that rays read");
    return images;
}

glm::vec4 meanTexel(const Scene& scene, const TextureSlot& slot, bool srgb) {
    if (!isPicture(scene, slot.image)) return glm::vec4(1);
    constexpr int kSide = 64;  // of the grid of points
    TextureSlot plain;
    plain.image = slot.image;
    plain.nearest = true;
    glm::vec4 sum(0);
    for (int i = 0; i < kSide * kSide; ++i) {
        const glm::vec2 uv = (glm::vec2(i % kSide, i / kSide) + 0.5f) / float(kSide);
        sum += sampleTexture(scene, plain, uv, srgb);
    }
    return sum / float(kSide * kSide);
}

}  // namespace phat
