#include "core/scene/rays.h"

#include <gtest/gtest.h>

#include <optional>

#include "core/base/hemisphere_map.h"
#include "core/base/random.h"
#include "support/ray_scenes.h"
#include "support/scene_builder.h"

namespace phat {
namespace {

using namespace test;

// Where a ray's line meets a triangle's plane, by Cramer's rule in double.
struct Crossing {
    double distance = 0;
    glm::dvec2 barycentric{0};
    bool fromBehind = false;
    double margin = 0;  // least barycentric coordinate: positive inside
};

std::optional<Crossing> cross(const Scene& scene, uint32_t triangle, glm::dvec3 origin,
                              glm::dvec3 direction) {
    const glm::uvec3 t = scene.triangles[triangle];
    const glm::dvec3 a(scene.positions[t.x]), ab = glm::dvec3(scene.positions[t.y]) - a,
                                              ac = glm::dvec3(scene.positions[t.z]) - a;
    const double volume = glm::determinant(glm::dmat3(ab, ac, -direction));
    if (std::abs(volume) < 1e-12) return std::nullopt;
    const glm::dvec3 to = origin - a;
    Crossing crossing;
    crossing.barycentric = {glm::determinant(glm::dmat3(to, ac, -direction)) / volume,
                            glm::determinant(glm::dmat3(ab, to, -direction)) / volume};
    crossing.distance = glm::determinant(glm::dmat3(ab, ac, to)) / volume;
    crossing.fromBehind = glm::dot(glm::cross(ab, ac), direction) > 0;
    const glm::dvec2 b = crossing.barycentric;
    crossing.margin = std::min(std::min(b.x, b.y), 1 - b.x - b.y);
    return crossing;
}

constexpr double kDoubt = 1e-4;  // float rounding may decide nearer to an edge than this

TEST(Rays, ClosestHitIsBruteForcesNearest) {
    const Scene scene = triangleSoup(200, 0.4f, 11);
    const RayScene rays(scene);
    Rng rng(12);
    int compared = 0, hits = 0, backs = 0;
    for (int i = 0; i < 20000; ++i) {
        const glm::vec3 origin = 1.5f * randomPoint(rng), direction = randomDirection(rng);
        std::optional<Crossing> nearest;
        uint32_t nearestTriangle = kNoTriangle;
        bool doubtful = false;
        for (uint32_t t = 0; t < scene.triangles.size(); ++t) {
            const auto crossing = cross(scene, t, origin, direction);
            if (!crossing || crossing->margin < -kDoubt || crossing->distance < -kDoubt) continue;
            doubtful |= crossing->margin < kDoubt || crossing->distance < kDoubt;
            if (nearest) doubtful |= std::abs(crossing->distance - nearest->distance) < kDoubt;
            if (nearest && nearest->distance < crossing->distance) continue;
            nearest = crossing;
            nearestTriangle = t;
        }
        if (doubtful) continue;
        ++compared;
        const Hit hit = rays.closestHit(origin, direction);
        ASSERT_EQ(hit.triangle, nearestTriangle) << i;
        if (!nearest) continue;
        ++hits;
        backs += hit.backFace;
        ASSERT_NEAR(hit.distance, nearest->distance, 1e-4);
        ASSERT_NEAR(hit.barycentric.x, nearest->barycentric.x, 2e-3);
        ASSERT_NEAR(hit.barycentric.y, nearest->barycentric.y, 2e-3);
        ASSERT_EQ(hit.backFace, nearest->fromBehind);
        // The open interval: what lies at the end does not count.
        ASSERT_EQ(rays.closestHit(origin, direction, hit.distance * 1.001f).triangle, hit.triangle);
        ASSERT_NE(rays.closestHit(origin, direction, hit.distance * 0.999f).triangle, hit.triangle);
        ASSERT_TRUE(rays.anyHit(origin, direction, hit.distance * 1.001f));
        ASSERT_FALSE(rays.anyHit(origin, direction, hit.distance * 0.999f));
    }
    EXPECT_GT(compared, 18000);
    EXPECT_GT(hits, 5000);
    EXPECT_GT(backs, hits / 3);
    EXPECT_LT(backs, hits * 2 / 3);
}

TEST(Rays, WindingTellsTheFront) {
    Scene scene;
    addFloor(scene, lambert(0.5f), 2);
    const RayScene rays(scene);
    EXPECT_FALSE(rays.closestHit({0.1f, 1, 0.2f}, {0, -1, 0}).backFace);
    EXPECT_TRUE(rays.closestHit({0.1f, -1, 0.2f}, {0, 1, 0}).backFace);
    std::swap(scene.triangles[0].y, scene.triangles[0].z);
    std::swap(scene.triangles[1].y, scene.triangles[1].z);
    const RayScene turned(scene);
    EXPECT_TRUE(turned.closestHit({0.1f, 1, 0.2f}, {0, -1, 0}).backFace);
    EXPECT_FALSE(turned.closestHit({0.1f, -1, 0.2f}, {0, 1, 0}).backFace);
}

// A leaf of two layers: two single-sided quads back to back at one place, with the same diagonal or the
// other.
TEST(Rays, CoincidentSidesAreMetFromTheFront) {
    for (const TwoLayers& layers : twoLayers()) {
        const RayScene rays(layers.scene);
        layers.expectFronts([&](const Ray& ray) { return rays.closestHit(ray.origin, ray.direction); });
    }
}

TEST(Rays, NothingMeetsAnEmptyScene) {
    const Scene scene;
    const RayScene rays(scene);
    EXPECT_FALSE(rays.closestHit({0, 0, 0}, {0, 0, 1}));
    EXPECT_FALSE(rays.anyHit({0, 0, 0}, {0, 0, 1}, 1e30f));
}

// (Aimed exactly at a vertex, one ray in 150 slips through Embree's robust mode; nothing in transport aims
// there.)
int escapes(const Scene& scene, glm::vec3 center, float extent, int count) {
    const RayScene rays(scene);
    int escaped = 0;
    for (const Ray& ray : raysAtEdges(scene, center, extent, count, 13))
        escaped +=
            !rays.closestHit(ray.origin, ray.direction) || !rays.anyHit(ray.origin, ray.direction, 1e30f);
    return escaped;
}

TEST(Rays, NoneEscapesAClosedMesh) {
    EXPECT_EQ(escapes(sphere(glm::vec3(0), 1, 64), glm::vec3(0), 0.5f, 500'000), 0);
    EXPECT_EQ(escapes(sphere({100, -50, 3}, 1, 64), {100, -50, 3}, 0.5f, 200'000), 0);
    Scene box;
    addRoom(box, lambert(0.5f), {1, 2, 3});
    EXPECT_EQ(escapes(box, {0.5f, 1, 1.5f}, 0.49f, 300'000), 0);
}

Scene alphaQuad(AlphaMode mode, float alpha) {
    Scene scene;
    Material material = lambert(0.5f);
    material.alphaMode = mode;
    material.baseColor.a = alpha;
    addQuad(scene, material, {0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    return scene;
}

TEST(Rays, MasksBlockWhereTheTextureSays) {
    Scene scene = alphaQuad(AlphaMode::mask, 1);
    Material& material = scene.materials[0];
    material.alphaCutoff = 0.5f;
    TextureImage image;
    image.width = image.height = 8;
    Rng rng(14);
    for (int i = 0; i < 64; ++i) image.texels.push_back({255, 255, 255, uint8_t(rng.bits() & 255)});
    scene.images.push_back(image);
    material.baseColorTexture.image = 0;
    material.baseColorTexture.nearest = true;
    const RayScene rays(scene);
    int blocked = 0;
    for (int i = 0; i < 64; ++i) {
        const glm::vec3 origin((float(i % 8) + 0.4f) / 8, (float(i / 8) + 0.3f) / 8, 1);
        const bool solid = float(image.texels[i].a) / 255 >= 0.5f;
        blocked += solid;
        EXPECT_EQ(bool(rays.closestHit(origin, {0, 0, -1})), solid) << i;
        EXPECT_EQ(rays.anyHit(origin, {0, 0, -1}, 2), solid) << i;
    }
    EXPECT_GT(blocked, 10);
    EXPECT_LT(blocked, 54);
}

TEST(Rays, BlendingStopsItsShareOfRays) {
    constexpr int kRays = 50'000;
    for (const float alpha : {0.0f, 0.1f, 0.5f, 0.85f, 1.0f}) {
        Scene scene = alphaQuad(AlphaMode::blend, alpha);
        addQuad(scene, scene.materials[0], {0, 0, -1}, {1, 0, 0}, {0, 1, 0});
        const RayScene rays(scene);
        const RayScene again(scene);
        Rng rng(15);
        int front = 0, behind = 0;
        for (int i = 0; i < kRays; ++i) {
            const glm::vec3 origin(rng.uniform2(), 1);
            const Hit hit = rays.closestHit(origin, {0, 0, -1});
            front += hit && hit.triangle < 2;
            behind += hit && hit.triangle >= 2;
            ASSERT_EQ(again.closestHit(origin, {0, 0, -1}).triangle, hit.triangle);
            ASSERT_EQ(rays.anyHit(origin, {0, 0, -1}, 3), bool(hit));
        }
        // Binomial, 4 standard deviations; the second sheet decides independently of the first.
        const auto expectFraction = [&](int count, double share) {
            EXPECT_NEAR(count, kRays * share, 4 * std::sqrt(kRays * share * (1 - share))) << alpha;
        };
        expectFraction(front, alpha);
        expectFraction(behind, (1.0 - alpha) * alpha);
    }
}

// The farthest step that the method may take on an axis: 256 units in the last place, or its fixed part of
// the scene.
float longestStep(float coordinate, float unitMeters) {
    const float ulp = std::nextafter(std::abs(coordinate), 1e30f) - std::abs(coordinate);
    return std::max(257 * ulp, unitMeters / 65536);
}

TEST(Rays, OffsetOriginsDoNotMeetTheirOwnTriangle) {
    Rng rng(16);
    struct Place {
        float size, away;
    };
    for (const auto [size, away] :
         {Place{1, 0}, {1, 1}, {1, 100}, {1, 1e4f}, {1e3f, 0}, {1e-3f, 0}, {1e-3f, 1}}) {
        for (int i = 0; i < 2000; ++i) {
            const glm::vec3 center = size * away * randomPoint(rng);
            const glm::vec3 corners[3] = {center + size * randomPoint(rng), center + size * randomPoint(rng),
                                          center + size * randomPoint(rng)};
            const glm::vec3 cross = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
            if (glm::length(cross) < 0.2f * size * size) continue;  // slivers have no normal in float
            Scene scene;
            addSurface(scene, lambert(0.5f));
            addTriangle(scene, corners, kNoUvs);
            const RayScene rays(scene);
            const glm::vec2 s = rng.uniform2();
            const glm::vec2 b = s.x + s.y > 1 ? 1.0f - s : s;
            const glm::vec3 position = corners[0] * (1 - b.x - b.y) + corners[1] * b.x + corners[2] * b.y;
            for (const float side : {1.0f, -1.0f}) {
                const glm::vec3 normal = side * glm::normalize(cross);
                const glm::vec3 origin = rays.offsetOrigin(position, normal);
                for (int axis = 0; axis < 3; ++axis)
                    ASSERT_LE(std::abs(origin[axis] - position[axis]),
                              longestStep(position[axis], rays.unitMeters()));
                const Frame frame = frameFromNormal(normal);
                for (int j = 0; j < 20; ++j) {
                    glm::vec3 local = squareToHemisphere(rng.uniform2());
                    if (j % 2) local.z *= 0.01f;  // grazing
                    const glm::vec3 direction = glm::normalize(frame.toWorld(local));
                    ASSERT_FALSE(rays.closestHit(origin, direction)) << size << ' ' << away << ' ' << i;
                    ASSERT_FALSE(rays.anyHit(origin, direction, 1e30f)) << size << ' ' << away << ' ' << i;
                }
            }
        }
    }
}

}  // namespace
}  // namespace phat
