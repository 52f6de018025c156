#pragma once
// Small procedural meshes for the atlas tests.

#include <cmath>
#include <functional>
#include <vector>

#include "core/base/random.h"
#include "core/scene/scene.h"

namespace phat::shapes {

/// Appends one surface. Normals are area-weighted averages; uv0 stays empty unless the caller fills it.
inline void add(Scene& scene, const std::vector<glm::vec3>& positions,
                const std::vector<glm::uvec3>& triangles) {
    if (scene.materials.empty()) scene.materials.emplace_back();
    Surface surface;
    surface.firstVertex = uint32_t(scene.positions.size());
    surface.vertexCount = uint32_t(positions.size());
    surface.firstTriangle = uint32_t(scene.triangles.size());
    surface.triangleCount = uint32_t(triangles.size());
    std::vector<glm::vec3> normals(positions.size(), glm::vec3(0));
    for (const glm::uvec3& t : triangles) {
        const glm::vec3 n = glm::cross(positions[t.y] - positions[t.x], positions[t.z] - positions[t.x]);
        for (int corner = 0; corner < 3; ++corner) normals[t[corner]] += n;
        scene.triangles.push_back(t + surface.firstVertex);
        scene.triangleSurface.push_back(uint32_t(scene.surfaces.size()));
    }
    for (const glm::vec3& n : normals)
        scene.normals.push_back(glm::length(n) > 0 ? glm::normalize(n) : glm::vec3(0, 0, 1));
    scene.positions.insert(scene.positions.end(), positions.begin(), positions.end());
    scene.surfaces.push_back(surface);
}

/// (columns x rows) quads over [0,1]^2, mapped by `place`; counter-clockwise for a right-handed map.
/// Seams of closed maps are left open: welding must close them.
inline void addGrid(Scene& scene, uint32_t columns, uint32_t rows,
                    const std::function<glm::vec3(float u, float v)>& place) {
    std::vector<glm::vec3> positions;
    std::vector<glm::uvec3> triangles;
    for (uint32_t y = 0; y <= rows; ++y)
        for (uint32_t x = 0; x <= columns; ++x)
            positions.push_back(place(float(x) / columns, float(y) / rows));
    for (uint32_t y = 0; y < rows; ++y) {
        for (uint32_t x = 0; x < columns; ++x) {
            const uint32_t i = y * (columns + 1) + x, up = i + columns + 1;
            triangles.push_back({i, i + 1, up + 1});
            triangles.push_back({i, up + 1, up});
        }
    }
    add(scene, positions, triangles);
}

/// All triangles as one surface, as modelling programs join them by material.
inline Scene joined(Scene scene) {
    Surface all = scene.surfaces[0];
    all.triangleCount = uint32_t(scene.triangles.size());
    all.vertexCount = uint32_t(scene.positions.size());
    scene.surfaces = {all};
    scene.triangleSurface.assign(scene.triangles.size(), 0);
    return scene;
}

inline Scene plane(float width, float height, uint32_t cells = 1) {
    Scene scene;
    addGrid(scene, cells, cells, [&](float u, float v) { return glm::vec3(u * width, v * height, 0.25f); });
    return scene;
}

inline Scene cube(float size) {
    Scene scene;
    std::vector<glm::vec3> p;
    for (int i = 0; i < 8; ++i) p.push_back(size * glm::vec3(i & 1, (i >> 1) & 1, i >> 2));
    add(scene, p,
        {{0, 2, 3},
         {0, 3, 1},
         {4, 5, 7},
         {4, 7, 6},
         {0, 1, 5},
         {0, 5, 4},
         {2, 6, 7},
         {2, 7, 3},
         {0, 4, 6},
         {0, 6, 2},
         {1, 3, 7},
         {1, 7, 5}});
    return scene;
}

/// Outward faces; the poles hold zero-area triangles, as exporters write them.
inline Scene sphere(float radius, uint32_t segments = 48, uint32_t rings = 24) {
    Scene scene;
    addGrid(scene, segments, rings, [&](float u, float v) {
        const float phi = u == 1 ? 0 : 2 * kPi * u, theta = kPi * v;
        const float s = v == 0 || v == 1 ? 0 : std::sin(theta);
        return radius * glm::vec3(s * std::cos(phi), s * std::sin(phi), -std::cos(theta));
    });
    return scene;
}

inline Scene torus(float major, float minor, uint32_t segments = 64, uint32_t sides = 32) {
    Scene scene;
    addGrid(scene, segments, sides, [&](float u, float v) {
        const float a = u == 1 ? 0 : 2 * kPi * u, b = v == 1 ? 0 : 2 * kPi * v;
        const float r = major + minor * std::cos(b);
        return glm::vec3(r * std::cos(a), r * std::sin(a), minor * std::sin(b));
    });
    return scene;
}

inline Scene cylinder(float radius, float height, uint32_t segments = 40) {
    Scene scene;
    addGrid(scene, segments, 4, [&](float u, float v) {
        const float a = u == 1 ? 0 : 2 * kPi * u;
        return glm::vec3(radius * std::cos(a), radius * std::sin(a), height * v);
    });
    return scene;
}

/// Half a twist: no consistent winding exists, so that one column of edges joins equal directions.
inline Scene moebius(float radius, float width, uint32_t segments = 60) {
    Scene scene;
    std::vector<glm::vec3> p;
    std::vector<glm::uvec3> t;
    for (uint32_t i = 0; i < segments; ++i) {
        const float a = 2 * kPi * float(i) / float(segments);
        for (const float side : {-0.5f, 0.5f}) {
            const float r = radius + side * width * std::cos(a / 2);
            p.push_back({r * std::cos(a), r * std::sin(a), side * width * std::sin(a / 2)});
        }
    }
    for (uint32_t i = 0; i < segments; ++i) {
        const uint32_t a = 2 * i, b = a + 1;
        const bool last = i + 1 == segments;
        const uint32_t c = last ? 1 : a + 2, d = last ? 0 : b + 2;
        t.push_back({a, c, d});
        t.push_back({a, d, b});
    }
    add(scene, p, t);
    return scene;
}

/// Unconnected random triangles, a few of them slivers.
inline Scene soup(uint32_t count) {
    Scene scene;
    std::vector<glm::vec3> p;
    std::vector<glm::uvec3> t;
    Rng rng(5);
    const auto point = [&] {
        const glm::vec2 xy = rng.uniform2();
        return glm::vec3(xy, rng.uniform());
    };
    for (uint32_t i = 0; i < count; ++i) {
        const glm::vec3 a = 3.0f * point();
        const float thin = i % 10 == 0 ? 0.001f : 1.0f;
        p.insert(p.end(), {a, a + 0.3f * point(), a + 0.3f * thin * point()});
        t.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    }
    add(scene, p, t);
    return scene;
}

/// A spiral ramp of `turns` turns: its projection along its mean normal covers itself.
inline Scene ramp(float turns) {
    Scene scene;
    addGrid(scene, uint32_t(40 * turns), 4, [&](float u, float v) {
        const float a = 2 * kPi * turns * u, r = 2 - v;
        return glm::vec3(r * std::cos(a), r * std::sin(a), 0.4f * turns * u);
    });
    return scene;
}

}  // namespace phat::shapes
