#include "gl/camera_matrices.h"

#include <algorithm>
#include <glm/gtc/matrix_transform.hpp>

#include "core/base/random.h"

namespace phat {
namespace {

// Of cameras without a near plane, in parts of what they reach.
constexpr float kMinNear = 1e-6f;

}  // namespace

CameraMatrices matricesOf(const Camera& camera, glm::uvec2 size, const Bounds& bounds, glm::vec2 jitter) {
    const float aspect = float(size.x) / float(size.y), across = camera.ymag * aspect;
    const glm::vec3 eye(camera.worldFromCamera[3]);
    const float reach = glm::distance(eye, bounds.center()) + 0.5f * bounds.diagonal();
    const float nearMeters = std::max(camera.znear, kMinNear * reach);
    const float farMeters = std::max(2 * nearMeters, 1.01f * reach);
    const glm::mat4 jittered = glm::translate(glm::mat4(1), glm::vec3(2.0f * jitter / glm::vec2(size), 0));
    const glm::mat4 cameraFromWorld = glm::inverse(camera.worldFromCamera);
    const glm::mat4 rotation{glm::mat3(cameraFromWorld)};
    if (camera.perspective) {
        // With the planes' places exchanged, depths are.
        const float fov = camera.yfovRadians;
        return {jittered * glm::perspectiveRH_ZO(fov, aspect, farMeters, nearMeters) * cameraFromWorld,
                glm::inverse(jittered * glm::perspective(fov, aspect, nearMeters, farMeters) * rotation)};
    }
    return {jittered * glm::orthoRH_ZO(-across, across, -camera.ymag, camera.ymag, farMeters, nearMeters) *
                cameraFromWorld,
            glm::inverse(jittered *
                         glm::ortho(-across, across, -camera.ymag, camera.ymag, nearMeters, farMeters) *
                         rotation)};
}

// Sobol's first two dimensions [Kollig and Keller 2002 for the second], moved so that the first of many
// points is near the pixel's centre and the mean of a power of two of them is there.
glm::vec2 jitterOf(int index, int count) {
    if (count == 1) return glm::vec2(0);
    uint32_t y = 0;
    for (uint32_t direction = 1u << 31, i = uint32_t(index); i != 0; i >>= 1, direction ^= direction >> 1)
        if (i & 1) y ^= direction;
    const glm::vec2 point = glm::vec2(glm::uvec2(reverseBits(uint32_t(index), 16), y >> 16)) / 65536.0f +
                            0.5f + 0.5f / float(count);
    return glm::fract(point) - 0.5f;
}

Eye eyeOf(const Camera& camera) {
    if (camera.perspective) return {glm::vec3(camera.worldFromCamera[3]), false};
    return {glm::normalize(glm::vec3(camera.worldFromCamera[2])), true};
}

}  // namespace phat
