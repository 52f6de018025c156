#include <fmt/format.h>

#include <array>
#include <cmath>
#include <fstream>

#include "io/base/file_error.h"
#include "io/gltf/gltf_loader.h"
#include "io/image/image_file.h"

namespace phat {
namespace {

// The largest half, at which the writers of suns stop that are brighter.
constexpr float kLargestHalf = 65504;
// Brighter than the sun's disc by far. Sums of more than this would leave the range of floats.
constexpr float kMaxRadiance = 1e9f;

bool isExr(const std::string& path) {
    constexpr std::array<char, 4> kMagic = {0x76, 0x2f, 0x31, 0x01};
    std::array<char, 4> first{};
    std::ifstream(path, std::ios::binary).read(first.data(), first.size());
    return first == kMagic;
}

float brightestFinite(const Image& image) {
    float brightest = 0;
    for (const glm::vec3& rgb : image.pixels)
        for (int c = 0; c < 3; ++c)
            if (std::isfinite(rgb[c])) brightest = std::max(brightest, rgb[c]);
    return std::min(brightest, kMaxRadiance);
}

}  // namespace

Environment loadEnvironment(const std::string& path, std::vector<std::string>* notes) {
    Environment environment{isExr(path) ? readExr(path) : readHdr(path)};
    const float infinite = std::max(kLargestHalf, brightestFinite(environment.radiance));
    size_t clamped = 0, undefined = 0;
    for (glm::vec3& rgb : environment.radiance.pixels) {
        const glm::vec3 before = rgb;
        bool nan = false;
        for (int c = 0; c < 3; ++c) {
            nan = nan || std::isnan(before[c]);
            // Skies that were filtered or painted hold slightly negative values; light is not.
            rgb[c] = !(before[c] > 0)        ? 0
                     : std::isinf(before[c]) ? infinite
                                             : std::min(before[c], kMaxRadiance);
        }
        undefined += nan;
        clamped += maxComponent(before) > kMaxRadiance;
    }
    if (notes && clamped > 0)
        notes->push_back(
            fmt::format("{}: {} infinite pixels are taken for a radiance of {:g}", path, clamped, infinite));
    if (notes && undefined > 0)
        notes->push_back(
            fmt::format("{}: {} pixels that are no numbers are taken for black", path, undefined));
    return environment;
}

}  // namespace phat
