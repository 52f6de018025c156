#include "core/base/math.h"

#include <cassert>

namespace phat {

Frame frameFromNormal(glm::vec3 n) {
    const float sign = std::copysign(1.0f, n.z);
    const float a = -1.0f / (sign + n.z);
    const float b = n.x * n.y * a;
    return {{1.0f + sign * n.x * n.x * a, sign * b, -sign * n.x}, {b, sign + n.y * n.y * a, -n.y}, n};
}

Frame frameFromNormalAndTangent(glm::vec3 normal, glm::vec3 tangent) {
    assert(isUnit(normal));
    const glm::vec3 t = tangent - glm::dot(tangent, normal) * normal;
    const float length2 = glm::dot(t, t);
    if (!(length2 > 1e-12f * glm::dot(tangent, tangent))) return frameFromNormal(normal);
    const glm::vec3 unit = t / std::sqrt(length2);
    return {unit, glm::cross(normal, unit), normal};
}

glm::vec3 spherePoint(int index, int count) {
    const double y = 1 - (2 * index + 1.0) / count, radius = std::sqrt(std::max(0.0, 1 - y * y));
    const double angle = 2.399963229728653 * index;  // the golden one
    return {radius * std::cos(angle), y, radius * std::sin(angle)};
}

}  // namespace phat
