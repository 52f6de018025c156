#pragma once
// Scenes and rays for the tests of ray queries, of Embree and of the trees that shaders traverse.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/hemisphere_map.h"
#include "core/base/random.h"
#include "core/scene/rays.h"
#include "support/scene_builder.h"

namespace phat::test {

inline const glm::vec2 kNoUvs[3] = {};

/// In [-1, 1]^3.
inline glm::vec3 randomPoint(Rng& rng) {
    const glm::vec2 xy = rng.uniform2();
    return 2.0f * glm::vec3(xy, rng.uniform()) - 1.0f;
}

inline glm::vec3 randomDirection(Rng& rng) {
    const glm::vec3 up = squareToHemisphere(rng.uniform2());
    return rng.uniform() < 0.5f ? up : -up;
}

inline Scene triangleSoup(int count, float size, uint64_t seed = 21) {
    Rng rng(seed);
    Scene scene;
    addSurface(scene, lambert(0.5f));
    for (int i = 0; i < count; ++i) {
        const glm::vec3 center = randomPoint(rng);
        const glm::vec3 corners[3] = {center + size * randomPoint(rng), center + size * randomPoint(rng),
                                      center + size * randomPoint(rng)};
        addTriangle(scene, corners, kNoUvs);
    }
    return scene;
}

/// A quad of two single-sided layers back to back, as leaves and paper have.
struct TwoLayers {
    Scene scene;

    static constexpr glm::vec3 kCorner{3, -7, 11}, kAcross{1, 0.3f, 0.1f}, kUp{-0.2f, 1, 0.4f};

    /// `closestHit`: of a Ray. From wherever they come, rays meet a front.
    template <typename ClosestHit>
    void expectFronts(const ClosestHit& closestHit) const {
        const glm::vec3 normal = glm::normalize(glm::cross(kAcross, kUp));
        Rng rng(3);
        for (int i = 0; i < 1000; ++i) {
            const float a = 0.1f + 0.8f * rng.uniform(), b = 0.1f + 0.8f * rng.uniform();
            const glm::vec3 direction = randomDirection(rng);
            if (std::abs(glm::dot(direction, normal)) < 0.05f) continue;
            const Hit hit = closestHit(Ray{kCorner + a * kAcross + b * kUp - 2.0f * direction, direction});
            ASSERT_TRUE(hit);
            EXPECT_FALSE(hit.backFace);
            EXPECT_NEAR(hit.distance, 2, 1e-4f);
        }
    }
};

/// Of the same triangles and of others, in either order.
inline std::vector<TwoLayers> twoLayers() {
    constexpr uint32_t kSides[][2][6] = {{{0, 1, 2, 0, 2, 3}, {0, 2, 1, 0, 3, 2}},
                                         {{0, 1, 2, 0, 2, 3}, {0, 3, 1, 3, 2, 1}}};
    constexpr auto k = TwoLayers::kCorner;
    const glm::vec3 corners[] = {k, k + TwoLayers::kAcross, k + TwoLayers::kAcross + TwoLayers::kUp,
                                 k + TwoLayers::kUp};
    std::vector<TwoLayers> result;
    for (const auto& sides : kSides) {
        for (const int first : {0, 1}) {
            Scene& scene = result.emplace_back().scene;
            addSurface(scene, lambert(0.5f));
            for (const int side : {first, 1 - first}) {
                for (int t = 0; t < 6; t += 3) {
                    const uint32_t* corner = sides[side] + t;
                    addTriangle(scene, std::array{corners[corner[0]], corners[corner[1]], corners[corner[2]]},
                                kNoUvs);
                }
            }
        }
    }
    return result;
}

/// A closed mesh; each triangle has corners of its own.
inline Scene sphere(glm::vec3 center, float radius, int rings) {
    Scene scene;
    addSurface(scene, lambert(0.5f));
    const auto at = [&](int ring, int sector) {
        const float theta = kPi * float(ring) / float(rings);
        const float phi = kPi * float(sector % (2 * rings)) / float(rings);
        if (ring == 0 || ring == rings) return center + radius * glm::vec3(0, ring == 0 ? 1 : -1, 0);
        return center + radius * glm::vec3(std::sin(theta) * std::cos(phi), std::cos(theta),
                                           std::sin(theta) * std::sin(phi));
    };
    for (int ring = 0; ring < rings; ++ring) {
        for (int sector = 0; sector < 2 * rings; ++sector) {
            const glm::vec3 a = at(ring, sector), b = at(ring, sector + 1), c = at(ring + 1, sector + 1),
                            d = at(ring + 1, sector);
            if (ring > 0) addTriangle(scene, std::array{a, b, c}, kNoUvs);
            if (ring < rings - 1) addTriangle(scene, std::array{a, c, d}, kNoUvs);
        }
    }
    return scene;
}

/// Moves and scales everything.
inline void transform(Scene& scene, glm::vec3 scale, glm::vec3 offset) {
    for (glm::vec3& p : scene.positions) p = scale * p + offset;
}

/// Adds the surfaces of a scene of one material as those of a glTF node.
inline void addNode(Scene& scene, const Scene& added, uint32_t node) {
    for (const Surface& surface : added.surfaces) {
        addSurface(scene, added.materials[surface.material]);
        scene.surfaces.back().node = node;
        for (uint32_t t = surface.firstTriangle; t < surface.firstTriangle + surface.triangleCount; ++t) {
            const glm::uvec3 from = added.triangles[t];
            const glm::vec3 corners[3] = {added.positions[from.x], added.positions[from.y],
                                          added.positions[from.z]};
            const glm::vec2 uvs[3] = {added.uv0[from.x], added.uv0[from.y], added.uv0[from.z]};
            addTriangle(scene, corners, uvs);
        }
    }
}

/// A room of node 0 with spheres (1, 2, ...) that are masked, blended and opaque in turn.
inline Scene roomOfSpheres(int spheres) {
    Scene scene;
    addRoom(scene, lambert(0.5f), {4, 3, 5});
    Rng rng(22);
    TextureImage image;
    image.width = 8;
    image.height = 4;
    for (int i = 0; i < 32; ++i) image.texels.push_back({255, 255, 255, uint8_t(rng.bits() & 255)});
    scene.images.push_back(image);
    for (int i = 0; i < spheres; ++i) {
        Scene ball = sphere(glm::vec3(2, 1.5f, 2.5f) + 1.2f * randomPoint(rng), 0.5f, 8);
        for (glm::vec2& uv : ball.uv0) uv = 3.0f * rng.uniform2() - 1.0f;
        Material& material = ball.materials[0];
        material.alphaMode = std::array{AlphaMode::mask, AlphaMode::blend, AlphaMode::opaque}[size_t(i % 3)];
        material.baseColorTexture.image = 0;
        material.baseColorTexture.nearest = i % 2 == 0;
        material.baseColorTexture.wrapU =
            std::array{Wrap::repeat, Wrap::mirroredRepeat, Wrap::clampToEdge}[size_t(i / 2 % 3)];
        material.baseColorTexture.uvTransform = glm::mat3x2(0.8f, 0.1f, -0.2f, 0.9f, 0.3f, 0.1f);
        material.baseColor.a = 0.9f;
        addNode(scene, ball, uint32_t(i + 1));
    }
    scene.nodes.resize(size_t(spheres) + 1);
    return scene;
}

/// A ray of one of six kinds: at an edge, at a corner, along an axis, with a component of zero, grazing a
/// triangle, anywhere.
inline Ray adversarialRay(const Scene& scene, glm::vec3 origin, Rng& rng) {
    const glm::uvec3 t = scene.triangles[rng.bits() % scene.triangles.size()];
    const glm::vec3 a = scene.positions[t.x], b = scene.positions[t.y], c = scene.positions[t.z];
    const auto toward = [&](glm::vec3 target) {
        const glm::vec3 d = target - origin;
        return glm::dot(d, d) > 0 ? glm::normalize(d) : glm::vec3(0, 0, 1);
    };
    switch (rng.bits() % 6) {
        case 0:
            return {origin, toward(glm::mix(a, b, rng.uniform()))};
        case 1:
            return {origin, toward(a)};
        case 2: {
            glm::vec3 axis(0);
            axis[int(rng.bits() % 3)] = rng.uniform() < 0.5f ? 1.0f : -1.0f;
            return {rng.uniform() < 0.5f ? origin : a, axis};  // from a corner on, too
        }
        case 3: {
            glm::vec3 inPlane = randomDirection(rng);
            inPlane[int(rng.bits() % 3)] = rng.uniform() < 0.5f ? 0.0f : -0.0f;
            return {origin, glm::normalize(inPlane)};
        }
        case 4: {  // grazing
            const glm::vec3 middle = (a + b + c) / 3.0f, along = b - a;
            if (!(glm::dot(along, along) > 0)) return {origin, toward(middle)};
            const glm::vec3 from = middle - 2.0f * along + 1e-3f * glm::length(along) * randomPoint(rng);
            const glm::vec3 d = middle - from;
            return {from, glm::dot(d, d) > 0 ? glm::normalize(d) : glm::vec3(1, 0, 0)};
        }
        default:
            return {origin, randomDirection(rng)};
    }
}

/// From anywhere in the scene's bounds, times `extent`.
inline std::vector<Ray> adversarialRays(const Scene& scene, int count, float extent, uint64_t seed) {
    Rng rng(seed);
    const Bounds bounds = boundsOf(scene);
    std::vector<Ray> rays;
    for (int i = 0; i < count; ++i)
        rays.push_back(adversarialRay(
            scene, bounds.center() + extent * 0.5f * (bounds.high - bounds.low) * randomPoint(rng), rng));
    return rays;
}

inline std::vector<Ray> randomRays(const Scene& scene, int count, float extent, uint64_t seed) {
    Rng rng(seed);
    const Bounds bounds = boundsOf(scene);
    std::vector<Ray> rays;
    for (int i = 0; i < count; ++i)
        rays.push_back({bounds.center() + extent * 0.5f * (bounds.high - bounds.low) * randomPoint(rng),
                        randomDirection(rng)});
    return rays;
}

/// Half of the rays go straight for an edge, the others anywhere.
inline std::vector<Ray> raysAtEdges(const Scene& scene, glm::vec3 center, float extent, int count,
                                    uint64_t seed = 54) {
    Rng rng(seed);
    std::vector<Ray> rays;
    for (int i = 0; i < count; ++i) {
        const glm::vec3 origin = center + extent * randomPoint(rng);
        glm::vec3 direction = randomDirection(rng);
        if (i % 2) {
            const glm::uvec3 t = scene.triangles[rng.bits() % scene.triangles.size()];
            direction =
                glm::normalize(glm::mix(scene.positions[t.x], scene.positions[t.y], rng.uniform()) - origin);
        }
        rays.push_back({origin, direction});
    }
    return rays;
}

/// A closed room around (1.9, 1.6, 2) of flat tiles, each wall a node.
inline Scene tiledRoom() {
    constexpr int kTiles = 24;
    Scene walls;
    for (int axis = 0; axis < 3; ++axis) {
        for (const float far : {0.0f, 1.0f}) {
            addSurface(walls, lambert(0.5f));
            walls.surfaces.back().node = uint32_t(walls.surfaces.size());
            for (int i = 0; i < kTiles * kTiles; ++i) {
                const auto at = [&](int x, int y) {
                    glm::vec3 p(0.37f, 0.11f, 0.53f);
                    p[axis] += 3.1f * far;
                    p[(axis + 1) % 3] += 3.1f * (float(i % kTiles + x) / kTiles);
                    p[(axis + 2) % 3] += 3.1f * (float(i / kTiles + y) / kTiles);
                    return p;
                };
                addTriangle(walls, std::array{at(0, 0), at(1, 0), at(1, 1)}, kNoUvs);
                addTriangle(walls, std::array{at(0, 0), at(1, 1), at(0, 1)}, kNoUvs);
            }
        }
    }
    return walls;
}

}  // namespace phat::test
