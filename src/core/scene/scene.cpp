#include "core/scene/scene.h"

#include <glm/gtc/matrix_transform.hpp>

namespace phat {

Bounds boundsOf(const Scene& scene) {
    Bounds bounds;
    for (const glm::uvec3& t : scene.triangles)
        for (int corner = 0; corner < 3; ++corner) bounds.add(scene.positions[t[corner]]);
    return bounds;
}

Camera defaultCamera(const Scene& scene) {
    const Bounds bounds = boundsOf(scene);
    const glm::vec3 target = bounds.empty() ? glm::vec3(0) : bounds.center();
    const float radius = std::max(0.5f * bounds.diagonal(), 1e-3f);

    Camera camera;
    camera.name = "default";
    camera.yfovRadians = 0.7f;
    camera.znear = radius * 1e-3f;
    const float distance = 1.1f * radius / std::sin(0.5f * camera.yfovRadians);
    const glm::vec3 eye = target + distance * glm::normalize(glm::vec3(0.6f, 0.45f, 1.0f));
    camera.worldFromCamera = glm::inverse(glm::lookAt(eye, target, glm::vec3(0, 1, 0)));
    return camera;
}

}  // namespace phat
