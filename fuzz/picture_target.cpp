#include <cmath>

#include "expect.h"
#include "io/base/file_error.h"
#include "io/gltf/gltf_loader.h"
#include "io/gltf/gltf_picture.h"
#include "io/image/image_file.h"
#include "scratch_file.h"
#include "targets.h"

namespace phat::fuzz {
namespace {

void readFile(const std::string& path) {
    try {
        const Image image = readPicture(path);
        expect(image.pixels.size() == size_t(image.width) * size_t(image.height), "pixels of a picture");
    } catch (const FileError&) {
    }
}

void readSky(const std::string& path) {
    try {
        for (const glm::vec3& rgb : loadEnvironment(path).radiance.pixels)
            expect(rgb.x >= 0 && rgb.y >= 0 && rgb.z >= 0 && std::isfinite(rgb.x + rgb.y + rgb.z),
                   "radiance that is finite and not negative");
    } catch (const FileError&) {
    }
}

void decodeTexture(Bytes bytes) {
    phat::gltf::MemoryBudget budget(bytes.size());
    try {
        const TextureImage image = phat::gltf::decodePicture(bytes, budget);
        expect(image.texels.size() == size_t(image.width) * size_t(image.height), "texels of a texture");
    } catch (const phat::gltf::Problem&) {
    }
}

}  // namespace

void picture(Bytes bytes) {
    const ScratchFile file(bytes, "picture");
    readFile(file.path());
    readSky(file.path());
    decodeTexture(bytes);
}

}  // namespace phat::fuzz
