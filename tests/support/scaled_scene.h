#pragma once
// One scene in several sizes: what must not change its picture.

#include <glm/gtc/matrix_transform.hpp>

#include "support/scene_builder.h"

namespace phat::test {

/// The same scene with every length times `factor`. A lamp at a point needs the square of it, to light what
/// is so much farther away as before.
inline Scene scaledScene(Scene scene, float factor) {
    for (glm::vec3& p : scene.positions) p *= factor;
    for (PunctualLight& light : scene.lights) {
        light.position *= factor;
        light.rangeMeters *= factor;
        if (light.type != PunctualLight::Type::directional) light.intensity *= factor * factor;
    }
    for (Camera& camera : scene.cameras) {
        for (int axis = 0; axis < 3; ++axis) camera.worldFromCamera[3][axis] *= factor;
        camera.ymag *= factor;
        camera.znear *= factor;
    }
    for (Material& material : scene.materials) {
        material.thickness *= factor;
        material.attenuationDistance *= factor;
    }
    return scene;
}

/// A room without a ceiling and with two walls: a glossy floor, a board that stands on it, a lamp with an
/// area, a spot with a range, the sun, a camera.
inline Scene litTerrace() {
    Scene scene;
    Material floor = lambert(0.8f), board = lambert(0.5f);
    floor.metallic = 1;
    floor.roughness = 0.35f;
    board.doubleSided = true;
    // No side is as long as another: rounding must not decide which way round a chart lies.
    addQuad(scene, floor, {-2, 0, -2}, {0, 0, 3.7f}, {4, 0, 0});
    addQuad(scene, lambert(0.7f), {-2, 0, -2}, {4, 0, 0}, {0, 2.5f, 0});
    addQuad(scene, lambert(0.4f), {-2, 0, 1.7f}, {0, 0, -3.7f}, {0, 2.3f, 0});
    addQuad(scene, emitter(glm::vec3(6, 5, 4)), {-0.6f, 1.2f, -1.95f}, {1.2f, 0, 0}, {0, 0.6f, 0});
    addQuad(scene, board, {0.3f, 0, -0.4f}, {0.9f, 0, 0.2f}, {0, 0.8f, 0});
    scene.lights.push_back(directionalLight({3, 3, 2}, glm::normalize(glm::vec3(-0.4f, -1, -0.5f))));
    scene.lights.push_back(
        spotLight({5, 6, 8}, {1.2f, 2.2f, 1}, glm::normalize(glm::vec3(-1, -2, -0.8f)), 20, 40));
    scene.lights.back().rangeMeters = 5;
    Camera camera;
    camera.worldFromCamera = glm::inverse(
        glm::lookAt(glm::vec3(1.4f, 1.5f, 2.6f), glm::vec3(-0.2f, 0.5f, -0.6f), glm::vec3(0, 1, 0)));
    camera.yfovRadians = glm::radians(50.0f);
    camera.znear = 0.05f;
    scene.cameras.push_back(camera);
    return scene;
}

/// What a file in millimetres or in kilometres has of a metre; and a power of two, by which floats scale
/// exactly.
inline constexpr float kScales[] = {1000, 0.001f, 1024};

/// How far two means may be apart: half a per cent.
inline constexpr double kSameMean = 0.005;

}  // namespace phat::test
