#include <array>
#include <cmath>
#include <fstream>

#include "io/base/file_error.h"
#include "io/gltf/gltf_loader.h"
#include "io/image/image_file.h"

namespace phat {
namespace {

bool isExr(const std::string& path) {
    constexpr std::array<char, 4> kMagic = {0x76, 0x2f, 0x31, 0x01};
    std::array<char, 4> first{};
    std::ifstream(path, std::ios::binary).read(first.data(), first.size());
    return first == kMagic;
}

// Skies that were filtered or painted hold slightly negative values and the odd NaN; light is neither.
float asRadiance(float value) {
    return value > 0 && std::isfinite(value) ? value : 0;
}

}  // namespace

Environment loadEnvironment(const std::string& path) {
    Environment environment{isExr(path) ? readExr(path) : readHdr(path)};
    for (glm::vec3& rgb : environment.radiance.pixels) {
        rgb = {asRadiance(rgb.x), asRadiance(rgb.y), asRadiance(rgb.z)};
    }
    return environment;
}

}  // namespace phat
