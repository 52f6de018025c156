#pragma once
// Scenes made in the tests, with every vertex array filled as the loader does.

#include <span>

#include "core/scene/scene.h"

namespace phat::test {

inline Material lambert(float albedo) {
    Material material;
    material.baseColor = glm::vec4(glm::vec3(albedo), 1);
    material.metallic = 0;
    material.specular = 0;
    return material;
}

inline Material emitter(glm::vec3 nit, float albedo = 0) {
    Material material = lambert(albedo);
    material.emission = nit;
    return material;
}

inline uint32_t addMaterial(Scene& scene, const Material& material) {
    scene.materials.push_back(material);
    return uint32_t(scene.materials.size() - 1);
}

/// A new surface without triangles; addTriangle appends to the last one.
inline void addSurface(Scene& scene, const Material& material) {
    Surface surface;
    surface.material = addMaterial(scene, material);
    surface.firstTriangle = uint32_t(scene.triangles.size());
    surface.firstVertex = uint32_t(scene.positions.size());
    scene.surfaces.push_back(surface);
}

/// Flat, with its own vertices; uv as given.
inline void addTriangle(Scene& scene, std::span<const glm::vec3, 3> corners,
                        std::span<const glm::vec2, 3> uv) {
    Surface& surface = scene.surfaces.back();
    const uint32_t first = uint32_t(scene.positions.size());
    const glm::vec3 normal = glm::normalize(glm::cross(corners[1] - corners[0], corners[2] - corners[0]));
    for (int i = 0; i < 3; ++i) {
        scene.positions.push_back(corners[i]);
        scene.normals.push_back(normal);
        scene.tangents.push_back(glm::vec4(0));
        scene.uv0.push_back(uv[i]);
        scene.uv1.push_back(uv[i]);
        scene.colors.push_back(glm::vec4(1));
    }
    scene.triangles.push_back({first, first + 1, first + 2});
    scene.triangleSurface.push_back(uint32_t(scene.surfaces.size() - 1));
    ++surface.triangleCount;
    surface.vertexCount += 3;
}

/// Two triangles over corner, corner + along, corner + across; the front is where along x across points.
inline void addQuad(Scene& scene, const Material& material, glm::vec3 corner, glm::vec3 along,
                    glm::vec3 across) {
    addSurface(scene, material);
    const glm::vec3 a[] = {corner, corner + along, corner + along + across};
    const glm::vec3 b[] = {corner, corner + along + across, corner + across};
    const glm::vec2 uvA[] = {{0, 0}, {1, 0}, {1, 1}}, uvB[] = {{0, 0}, {1, 1}, {0, 1}};
    addTriangle(scene, a, uvA);
    addTriangle(scene, b, uvB);
}

/// Centred in the plane y = height; the front looks up.
inline void addFloor(Scene& scene, const Material& material, float size, float height = 0) {
    addQuad(scene, material, {-size / 2, height, -size / 2}, {0, 0, size}, {size, 0, 0});
}

/// The same, looking down.
inline void addCeiling(Scene& scene, const Material& material, float size, float height) {
    addQuad(scene, material, {-size / 2, height, -size / 2}, {size, 0, 0}, {0, 0, size});
}

/// Six quads (surfaces) from the origin to `size` that look inward: x = 0, x = size.x, y = 0, ...
inline void addRoom(Scene& scene, const Material& material, glm::vec3 size) {
    for (int axis = 0; axis < 3; ++axis) {
        glm::vec3 along(0), across(0), far(0);
        along[(axis + 1) % 3] = size[(axis + 1) % 3];
        across[(axis + 2) % 3] = size[(axis + 2) % 3];
        far[axis] = size[axis];
        addQuad(scene, material, glm::vec3(0), along, across);
        addQuad(scene, material, far, across, along);
    }
}

/// Six quads that look outward: their surfaces close a volume.
inline void addOutwardBox(Scene& scene, const Material& material, glm::vec3 low, glm::vec3 size) {
    for (int axis = 0; axis < 3; ++axis) {
        glm::vec3 along(0), across(0), far(0);
        along[(axis + 1) % 3] = size[(axis + 1) % 3];
        across[(axis + 2) % 3] = size[(axis + 2) % 3];
        far[axis] = size[axis];
        addQuad(scene, material, low, across, along);
        addQuad(scene, material, low + far, along, across);
    }
}

inline PunctualLight pointLight(glm::vec3 candela, glm::vec3 position) {
    PunctualLight light;
    light.intensity = candela;
    light.position = position;
    return light;
}

inline PunctualLight spotLight(glm::vec3 candela, glm::vec3 position, glm::vec3 direction, float innerDegrees,
                               float outerDegrees) {
    PunctualLight light = pointLight(candela, position);
    light.type = PunctualLight::Type::spot;
    light.direction = direction;
    light.cosInnerCone = std::cos(glm::radians(innerDegrees));
    light.cosOuterCone = std::cos(glm::radians(outerDegrees));
    return light;
}

inline PunctualLight directionalLight(glm::vec3 lux, glm::vec3 direction) {
    PunctualLight light;
    light.type = PunctualLight::Type::directional;
    light.intensity = lux;
    light.direction = direction;
    return light;
}

/// Opaque grey texels, [y][x]; `grey` are sRGB codes.
inline int32_t addGreyImage(Scene& scene, int width, int height, std::span<const uint8_t> grey) {
    TextureImage image;
    image.width = width;
    image.height = height;
    for (uint8_t code : grey) image.texels.push_back({code, code, code, 255});
    scene.images.push_back(image);
    return int32_t(scene.images.size() - 1);
}

}  // namespace phat::test
