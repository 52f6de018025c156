#pragma once
// What holds for every loaded scene, whatever the file.

#include <gtest/gtest.h>

#include <cmath>

#include "core/scene/scene.h"

namespace phat::test {

inline bool isFinite(glm::vec4 v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z) && std::isfinite(v.w);
}

/// Counts the broken promises of scene.h; 0 is sound.
inline int countUnsound(const Scene& scene) {
    int unsound = 0;
    const auto expect = [&](bool good) { unsound += !good; };
    const size_t vertices = scene.positions.size();
    expect(scene.normals.size() == vertices && scene.tangents.size() == vertices &&
           scene.uv0.size() == vertices && scene.uv1.size() == vertices && scene.colors.size() == vertices);
    expect(scene.triangleSurface.size() == scene.triangles.size());
    if (unsound > 0) return unsound;
    for (size_t v = 0; v < vertices; ++v) {
        expect(isFinite({scene.positions[v], 0}) && isFinite({scene.uv0[v], scene.uv1[v]}));
        expect(std::abs(glm::length(scene.normals[v]) - 1) < 1e-4f);
        const glm::vec4 tangent = scene.tangents[v];
        expect(tangent == glm::vec4(0) ||
               (std::abs(glm::length(glm::vec3(tangent)) - 1) < 1e-4f && std::abs(tangent.w) == 1));
        expect(scene.colors[v] == glm::clamp(scene.colors[v], 0.0f, 1.0f));
    }
    uint32_t nextTriangle = 0, nextVertex = 0;
    for (size_t s = 0; s < scene.surfaces.size(); ++s) {
        const Surface& surface = scene.surfaces[s];
        expect(surface.firstTriangle == nextTriangle && surface.firstVertex == nextVertex);
        expect(surface.triangleCount > 0 && surface.material < scene.materials.size());
        nextTriangle += surface.triangleCount;
        nextVertex += surface.vertexCount;
        if (nextTriangle > scene.triangles.size()) return unsound + 1;
        for (uint32_t t = surface.firstTriangle; t < nextTriangle; ++t) {
            expect(scene.triangleSurface[t] == s);
            for (int corner = 0; corner < 3; ++corner)
                expect(scene.triangles[t][corner] >= surface.firstVertex &&
                       scene.triangles[t][corner] < nextVertex);
        }
    }
    expect(nextTriangle == scene.triangles.size() && nextVertex == vertices);
    for (const Material& material : scene.materials) {
        expect(isFinite(material.baseColor) && isFinite({material.emission, material.roughness}));
        for (const TextureSlot* slot :
             {&material.baseColorTexture, &material.metallicRoughnessTexture, &material.normalTexture,
              &material.emissionTexture, &material.specularTexture, &material.specularColorTexture,
              &material.clearcoatTexture, &material.clearcoatRoughnessTexture,
              &material.clearcoatNormalTexture, &material.transmissionTexture, &material.thicknessTexture}) {
            expect(slot->image >= -1 && slot->image < int32_t(scene.images.size()));
            expect(slot->uvSet == 0 || slot->uvSet == 1);
        }
    }
    for (const TextureImage& image : scene.images) {
        expect(image.width > 0 && image.height > 0);
        expect(image.texels.size() == size_t(image.width) * size_t(image.height));
    }
    for (const Camera& camera : scene.cameras)
        for (int column = 0; column < 4; ++column) expect(isFinite(camera.worldFromCamera[column]));
    for (const PunctualLight& light : scene.lights) {
        expect(isFinite({light.intensity, light.rangeMeters}) && isFinite({light.position, 0}));
        expect(std::abs(glm::length(light.direction) - 1) < 1e-4f);
    }
    return unsound;
}

/// Winding agrees with the normals: every triangle of a closed or planar test mesh faces its vertex normals.
inline glm::vec3 faceNormal(const Scene& scene, size_t triangle) {
    const glm::uvec3 t = scene.triangles[triangle];
    const glm::vec3 p = scene.positions[t[0]];
    return glm::normalize(glm::cross(scene.positions[t[1]] - p, scene.positions[t[2]] - p));
}

}  // namespace phat::test
