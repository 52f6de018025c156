#include "core/scene/light_bound.h"

#include <algorithm>

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

}  // namespace phat
