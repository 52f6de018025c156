#include "core/dynamic/view_test.h"

#include <cmath>

namespace phat {

ViewTest::ViewTest(const Camera& camera)
    : cameraFromWorld_(glm::inverse(camera.worldFromCamera)),
      eye_(camera.worldFromCamera[3]),
      perspective_(camera.perspective),
      halfHeight_(camera.perspective ? std::tan(0.5f * camera.yfovRadians) : camera.ymag),
      aspect_(camera.aspect > 0 ? camera.aspect : 16.0f / 9) {}

bool ViewTest::maySee(glm::vec3 center, glm::vec3 normal, float radius) const {
    const glm::vec3 p = cameraFromWorld_ * glm::vec4(center, 1.0f);
    if (!perspective_)
        return std::abs(p.y) < halfHeight_ + radius && std::abs(p.x) < halfHeight_ * aspect_ + radius;
    if (p.z > radius) return false;
    if (glm::dot(eye_ - center, normal) < -radius) return false;
    const float half = -p.z * halfHeight_;
    return std::abs(p.y) < half + 2 * radius && std::abs(p.x) < half * aspect_ + 2 * radius;
}

}  // namespace phat
