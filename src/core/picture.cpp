#include "core/picture.h"

#include <chrono>

#include "core/parallel.h"

namespace phat {
namespace {

// Sums of double: thousands of samples of a lamp must not drown the dark ones.
struct PixelSums {
    glm::dvec3 value{0};
    glm::dvec3 square{0};
};

constexpr size_t kRangePixels = 64;

glm::dvec3 varianceOfMean(const PixelSums& sums, double count) {
    if (count < 2) return glm::dvec3(0);
    const glm::dvec3 spread = glm::max(sums.square - sums.value * sums.value / count, glm::dvec3(0));
    return spread / (count * (count - 1));
}

}  // namespace

CameraRay cameraRay(const Camera& camera, int width, int height, glm::vec2 place) {
    const float aspect = float(width) / float(height);
    const glm::vec2 ndc(2 * place.x / float(width) - 1, 1 - 2 * place.y / float(height));
    const glm::mat3 rotation(camera.worldFromCamera);
    const glm::vec3 eye(camera.worldFromCamera[3]);
    if (camera.perspective) {
        const float half = std::tan(0.5f * camera.yfovRadians);
        return {eye, glm::normalize(rotation * glm::vec3(ndc.x * half * aspect, ndc.y * half, -1))};
    }
    const glm::vec3 offset = rotation * glm::vec3(ndc.x * camera.ymag * aspect, ndc.y * camera.ymag, 0);
    return {eye + offset, glm::normalize(rotation * glm::vec3(0, 0, -1))};
}

TracedPicture tracePicture(const PictureSettings& settings, const Integrator& integrator,
                           Progress& progress) {
    const auto start = std::chrono::steady_clock::now();
    const auto secondsSinceStart = [&] {
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    };
    const size_t pixelCount = size_t(settings.width) * size_t(settings.height);
    std::vector<PixelSums> sums(pixelCount);
    const bool timed = settings.seconds > 0;
    // A pass ends soon enough to look at the clock, and is long enough not to wait for its slowest pixels.
    const int perPass = timed ? 1 : std::min(settings.samplesPerPixel, 16);

    int done = 0;
    while (timed ? done == 0 || secondsSinceStart() < settings.seconds : done < settings.samplesPerPixel) {
        const int end = timed ? done + 1 : std::min(done + perPass, settings.samplesPerPixel);
        parallelRanges(pixelCount, kRangePixels, progress, [&](size_t first, size_t last) {
            for (size_t pixel = first; pixel < last; ++pixel) {
                const glm::vec2 corner(pixel % size_t(settings.width), pixel / size_t(settings.width));
                for (int sample = done; sample < end; ++sample) {
                    Rng rng(hashOf(settings.seed, pixel, uint64_t(sample)));
                    const glm::vec2 place = corner + rng.uniform2();
                    const glm::dvec3 value(
                        integrator(cameraRay(settings.camera, settings.width, settings.height, place), rng));
                    sums[pixel].value += value;
                    sums[pixel].square += value * value;
                }
            }
        });
        done = end;
    }

    TracedPicture picture{Image(settings.width, settings.height), Image(settings.width, settings.height),
                          done};
    for (size_t pixel = 0; pixel < pixelCount; ++pixel) {
        picture.mean.pixels[pixel] = glm::vec3(sums[pixel].value / double(done));
        picture.variance.pixels[pixel] = glm::vec3(varianceOfMean(sums[pixel], double(done)));
    }
    return picture;
}

}  // namespace phat
