#include "io/gltf/gltf_lights_cameras.h"

#include <fmt/core.h>

#include <cmath>

#include "io/gltf/gltf_light_profiles.h"

namespace phat::gltf {
namespace {

std::string nameOf(const std::string& node, const std::string& own, const char* kind, size_t index) {
    if (!node.empty()) return node;
    return own.empty() ? fmt::format("{} {}", kind, index) : own;
}

bool isNear(glm::dvec3 position) {
    for (int axis = 0; axis < 3; ++axis)
        if (!(std::abs(position[axis]) <= kMaxCoordinateMeters)) return false;
    return true;
}

// Zero-scaled nodes have no direction of their own.
glm::dvec3 unitOr(glm::dvec3 v, glm::dvec3 fallback) {
    const double length = glm::length(v);
    return length > 0 && std::isfinite(length) ? v / length : fallback;
}

glm::mat4 orthonormal(const glm::dmat4& worldFromNode) {
    const glm::dvec3 back = unitOr(glm::dvec3(worldFromNode[2]), {0, 0, 1});
    const glm::dvec3 someUp = std::abs(back.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(0, 0, 1);
    glm::dvec3 up = unitOr(glm::dvec3(worldFromNode[1]), someUp);
    up -= glm::dot(up, back) * back;
    if (glm::length(up) < 1e-6) up = someUp - glm::dot(someUp, back) * back;
    up = glm::normalize(up);
    const glm::dvec3 right = glm::cross(up, back);
    return glm::mat4(glm::dmat4(glm::dvec4(right, 0), glm::dvec4(up, 0), glm::dvec4(back, 0),
                                glm::dvec4(glm::dvec3(worldFromNode[3]), 1)));
}

Camera cameraOf(const tinygltf::Camera& in, const std::string& name, const glm::dmat4& worldFromNode) {
    Camera camera;
    camera.name = name;
    camera.worldFromCamera = orthonormal(worldFromNode);
    camera.perspective = in.type == "perspective";
    if (camera.perspective) {
        camera.yfovRadians = float(in.perspective.yfov);
        camera.aspect = float(in.perspective.aspectRatio);
        camera.znear = float(in.perspective.znear);
    } else {
        camera.ymag = float(std::abs(in.orthographic.ymag));
        camera.aspect = float(std::abs(in.orthographic.xmag / in.orthographic.ymag));
        camera.znear = float(in.orthographic.znear);
    }
    return camera;
}

void aim(PunctualLight& light, const glm::dmat4& worldFromNode) {
    const glm::mat4 frame = orthonormal(worldFromNode);
    light.position = glm::vec3(worldFromNode[3]);
    light.direction = glm::vec3(unitOr(-glm::dvec3(worldFromNode[2]), {0, 0, -1}));
    light.horizontalZero = glm::vec3(frame[0]);
}

PunctualLight lightOf(const tinygltf::Light& in, const std::string& name, const glm::dmat4& worldFromNode) {
    PunctualLight light;
    light.name = name;
    if (in.type == "spot") light.type = PunctualLight::Type::spot;
    if (in.type == "directional") light.type = PunctualLight::Type::directional;
    for (int c = 0; c < 3; ++c) {
        const double color = in.color.empty() ? 1.0 : std::max(in.color[size_t(c)], 0.0);
        light.intensity[c] = float(color * in.intensity);
    }
    aim(light, worldFromNode);
    if (light.type == PunctualLight::Type::spot) {
        light.cosInnerCone = float(std::cos(in.spot.innerConeAngle));
        light.cosOuterCone = float(std::cos(in.spot.outerConeAngle));
    }
    light.rangeMeters = float(in.range);
    return light;
}

}  // namespace

void readLightsAndCameras(const Document& document, const std::vector<WorldNode>& nodes, Scene& scene,
                          MemoryBudget& budget, Notes& notes) {
    const auto& model = document.model();
    LightProfiles profiles(document.source, budget, notes);
    for (const WorldNode& world : nodes) {
        const tinygltf::Node& node = model.nodes[world.node];
        const auto extension = node.extensions.find("KHR_lights_punctual");
        const bool hasLight = !world.hidden && extension != node.extensions.end();
        const bool hasProfile = !world.hidden && node.extensions.contains(kLightProfiles);
        if (!hasLight && !hasProfile && node.camera < 0) continue;
        if (!isNear(glm::dvec3(world.worldFromNode[3]))) {
            notes.lines.push_back(
                fmt::format("the light or camera of node {} is too far away and is left out", world.node));
            continue;
        }
        if (node.camera >= 0) {
            const auto& camera = model.cameras[size_t(node.camera)];
            scene.cameras.push_back(cameraOf(
                camera, nameOf(node.name, camera.name, "camera", size_t(node.camera)), world.worldFromNode));
        }
        if (hasLight) {
            const size_t index = size_t(extension->second.Get("light").GetNumberAsInt());
            const auto& light = model.lights[index];
            scene.lights.push_back(
                lightOf(light, nameOf(node.name, light.name, "light", index), world.worldFromNode));
            scene.lights.back().node = world.node;
        }
        PunctualLight measured;
        measured.name = node.name;
        if (hasProfile && profiles.give(world.node, measured)) {
            aim(measured, world.worldFromNode);
            measured.node = world.node;
            scene.lights.push_back(std::move(measured));
        }
    }
}

}  // namespace phat::gltf
