#include "core/scene/light_bound.h"

#include <algorithm>
#include <cmath>

#include "core/base/math.h"

namespace phat {

bool emittersReflect(const Scene& scene) {
    return std::any_of(scene.materials.begin(), scene.materials.end(), [](const Material& m) {
        if (m.unlit || m.emission == glm::vec3(0)) return false;
        const bool dielectric = m.metallic < 1 && m.specular > 0 && m.specularColor != glm::vec3(0);
        return glm::vec3(m.baseColor) != glm::vec3(0) || dielectric || m.clearcoat > 0;
    });
}

glm::vec3 brightestRadiance(const Scene& scene) {
    if (!scene.lights.empty() || emittersReflect(scene)) return glm::vec3(kUnbounded);
    glm::vec3 brightest(0);
    for (const Material& material : scene.materials) brightest = glm::max(brightest, material.emission);
    if (scene.environment)
        for (const glm::vec3& radiance : scene.environment->radiance.pixels)
            brightest = glm::max(brightest, radiance);
    return brightest == glm::vec3(0) ? glm::vec3(kUnbounded) : brightest;
}

double meanEnvironmentLuminance(const Scene& scene) {
    if (!scene.environment) return 0;
    const Image& image = scene.environment->radiance;
    double sum = 0;
    for (int y = 0; y < image.height; ++y) {
        double row = 0;
        for (int x = 0; x < image.width; ++x) row += double(luminance(image.at(x, y)));
        const auto cosine = [&](int line) { return std::cos(double(kPi) * line / image.height); };
        sum += row / image.width * (cosine(y) - cosine(y + 1));
    }
    return sum / 2;
}

}  // namespace phat
