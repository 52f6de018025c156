#pragma once
// Glass for the tests: panes, closed slabs, spheres.

#include <cmath>

#include "support/scene_builder.h"

namespace phat::test {

/// Colourless glass that reflects like an interface of index of refraction `ior`.
inline Material glass(float ior = 1.5f, float roughness = 0) {
    Material material;
    material.name = "glass";
    material.metallic = 0;
    material.roughness = roughness;
    material.transmission = 1;
    material.ior = ior;
    material.doubleSided = true;
    return material;
}

/// The same for the walls of a volume.
inline Material solidGlass(float ior = 1.5f, float roughness = 0) {
    Material material = glass(ior, roughness);
    material.thickness = 0.1f;
    material.doubleSided = false;
    return material;
}

/// A closed box that looks outward, one surface. `skipped`: one of its six faces that is left out, or -1.
inline void addBox(Scene& scene, const Material& material, glm::vec3 low, glm::vec3 high, int skipped = -1) {
    addSurface(scene, material);
    scene.surfaces.back().node = uint32_t(scene.surfaces.size());
    const glm::vec2 uv[] = {{0, 0}, {1, 0}, {1, 1}};
    for (int axis = 0; axis < 3; ++axis)
        for (const bool top : {false, true}) {
            if (2 * axis + int(top) == skipped) continue;
            const int a = (axis + 1) % 3, b = (axis + 2) % 3;
            const auto corner = [&](bool onA, bool onB) {
                glm::vec3 p = low;
                p[axis] = top ? high[axis] : low[axis];
                p[a] = onA ? high[a] : low[a];
                p[b] = onB ? high[b] : low[b];
                return p;
            };
            const glm::vec3 face[] = {corner(false, false), corner(true, false), corner(true, true),
                                      corner(false, true)};
            const glm::vec3 one[] = {face[0], face[top ? 1 : 2], face[top ? 2 : 1]};
            const glm::vec3 two[] = {face[0], face[top ? 2 : 3], face[top ? 3 : 2]};
            addTriangle(scene, one, uv);
            addTriangle(scene, two, uv);
        }
}

/// A closed sphere of flat triangles.
inline void addSphere(Scene& scene, const Material& material, glm::vec3 center, float radius, int rings) {
    addSurface(scene, material);
    scene.surfaces.back().node = uint32_t(scene.surfaces.size());
    const int around = 2 * rings;
    const auto at = [&](int ring, int step) {
        if (ring == 0 || ring == rings) return center + glm::vec3(0, ring == 0 ? radius : -radius, 0);
        const float polar = kPi * float(ring) / float(rings);
        const float azimuth = 2 * kPi * float(step % around) / float(around);
        return center + radius * glm::vec3(std::sin(polar) * std::cos(azimuth), std::cos(polar),
                                           std::sin(polar) * std::sin(azimuth));
    };
    const glm::vec2 uv[] = {{0, 0}, {1, 0}, {1, 1}};
    for (int ring = 0; ring < rings; ++ring)
        for (int step = 0; step < around; ++step) {
            const glm::vec3 a = at(ring, step), b = at(ring, step + 1), c = at(ring + 1, step + 1),
                            d = at(ring + 1, step);
            const glm::vec3 upper[] = {a, b, c}, lower[] = {a, c, d};
            if (ring > 0) addTriangle(scene, upper, uv);
            if (ring + 1 < rings) addTriangle(scene, lower, uv);
        }
}

/// An environment of one radiance everywhere.
inline Environment uniformSky(glm::vec3 radiance) {
    Environment sky;
    sky.radiance = Image(8, 4);
    for (glm::vec3& pixel : sky.radiance.pixels) pixel = radiance;
    return sky;
}

}  // namespace phat::test
