#pragma once
// What the loader does by way of the file (io/gltf/gltf_divide.h), for scenes made in the tests.

#include <span>

#include "core/atlas/divided_surfaces.h"

namespace phat::test {

template <typename T>
T blend(const std::vector<T>& values, uint32_t first, const CutVertex& vertex) {
    T sum(0);
    for (int i = 0; i < 3; ++i) sum += float(vertex.weight[i]) * values[first + vertex.from[i]];
    return sum;
}

inline void addBlendedVertex(Scene& scene, uint32_t first, const CutVertex& vertex) {
    scene.positions.push_back(blend(scene.positions, first, vertex));
    scene.uv0.push_back(blend(scene.uv0, first, vertex));
    scene.uv1.push_back(blend(scene.uv1, first, vertex));
    scene.colors.push_back(blend(scene.colors, first, vertex));
    const glm::vec3 normal = blend(scene.normals, first, vertex);
    scene.normals.push_back(glm::length(normal) > 0 ? glm::normalize(normal)
                                                    : scene.normals[first + vertex.from[0]]);
    glm::vec4 tangent = scene.tangents[first + vertex.from[0]];
    const glm::vec3 along = blend(scene.tangents, first, vertex);
    if (glm::length(along) > 0) tangent = glm::vec4(glm::normalize(along), tangent.w);
    scene.tangents.push_back(tangent);
}

template <typename T>
inline void appendRange(std::vector<T>& all, const std::vector<T>& from, uint32_t first, uint32_t count) {
    all.insert(all.end(), from.begin() + first, from.begin() + first + count);
}

inline void appendVertices(Scene& out, const Scene& scene, const Surface& surface) {
    appendRange(out.positions, scene.positions, surface.firstVertex, surface.vertexCount);
    appendRange(out.normals, scene.normals, surface.firstVertex, surface.vertexCount);
    appendRange(out.tangents, scene.tangents, surface.firstVertex, surface.vertexCount);
    appendRange(out.uv0, scene.uv0, surface.firstVertex, surface.vertexCount);
    appendRange(out.uv1, scene.uv1, surface.firstVertex, surface.vertexCount);
    appendRange(out.colors, scene.colors, surface.firstVertex, surface.vertexCount);
}

/// The scene with the parts as surfaces, those of a surface after each other.
inline Scene withParts(const Scene& scene, std::span<const DividedSurface> divided) {
    Scene out = scene;
    out.positions.clear();
    out.normals.clear();
    out.tangents.clear();
    out.uv0.clear();
    out.uv1.clear();
    out.colors.clear();
    out.triangles.clear();
    out.triangleSurface.clear();
    out.surfaces.clear();
    auto next = divided.begin();
    for (uint32_t s = 0; s < scene.surfaces.size(); ++s) {
        const Surface& surface = scene.surfaces[s];
        const DividedSurface* parts = next != divided.end() && next->surface == s ? &*next++ : nullptr;
        for (uint32_t part = 0; part < (parts ? parts->partCount : 1); ++part) {
            Surface own = surface;
            own.firstVertex = uint32_t(out.positions.size());
            own.firstTriangle = uint32_t(out.triangles.size());
            appendVertices(out, scene, surface);
            for (uint32_t t = 0; t < surface.triangleCount && !parts; ++t)
                out.triangles.push_back(scene.triangles[surface.firstTriangle + t] - surface.firstVertex +
                                        own.firstVertex);
            if (parts) {
                for (const CutVertex& vertex : parts->vertices)
                    addBlendedVertex(out, own.firstVertex, vertex);
                for (size_t t = 0; t < parts->triangles.size(); ++t)
                    if (parts->part[t] == part)
                        out.triangles.push_back(parts->triangles[t] + own.firstVertex);
            }
            own.vertexCount = uint32_t(out.positions.size()) - own.firstVertex;
            own.triangleCount = uint32_t(out.triangles.size()) - own.firstTriangle;
            out.triangleSurface.resize(out.triangles.size(), uint32_t(out.surfaces.size()));
            out.surfaces.push_back(std::move(own));
        }
    }
    return out;
}

}  // namespace phat::test
