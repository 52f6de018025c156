// Contact shadows of things: the closed form against rays, and what stands for things.

#include "core/scene/occluders.h"

#include <gtest/gtest.h>

#include <glm/gtc/matrix_transform.hpp>

#include "core/scene/brdf.h"
#include "core/scene/rays.h"
#include "support/scene_builder.h"

namespace phat {
namespace {

using namespace test;

void addSphere(Scene& scene, glm::vec3 center, float radius) {
    constexpr int kAround = 96, kUp = 48;
    const auto at = [&](int i, int j) {
        const float theta = kPi * float(j) / kUp, phi = 2 * kPi * float(i % kAround) / kAround;
        return center + radius * glm::vec3(std::sin(theta) * std::cos(phi), std::cos(theta),
                                           std::sin(theta) * std::sin(phi));
    };
    addSurface(scene, lambert(0));
    const glm::vec2 uv[3] = {};
    for (int j = 0; j < kUp; ++j)
        for (int i = 0; i < kAround; ++i) {
            const glm::vec3 a[3] = {at(i, j), at(i + 1, j), at(i + 1, j + 1)};
            const glm::vec3 b[3] = {at(i, j), at(i + 1, j + 1), at(i, j + 1)};
            addTriangle(scene, a, uv);
            addTriangle(scene, b, uv);
        }
}

/// What is left of the irradiance of a uniform sky, by rays to it.
double seenSky(const RayScene& rays, glm::vec3 position, glm::vec3 normal) {
    constexpr int kSide = 300;
    const Frame frame = frameFromNormal(normal);
    int seen = 0;
    for (int i = 0; i < kSide * kSide; ++i) {
        const glm::vec2 square(glm::vec2(float(i % kSide) + 0.5f, float(i / kSide) + 0.5f) / float(kSide));
        seen +=
            !rays.anyHit(position, glm::normalize(frame.toWorld(squareToCosineHemisphere(square))), 1e30f);
    }
    return double(seen) / (kSide * kSide);
}

double leftBy(const std::vector<Occluder>& occluders, glm::vec3 position, glm::vec3 normal) {
    double left = 1;
    for (const Occluder& occluder : occluders) left *= 1 - occlusionBy(occluder, position, normal);
    return left;
}

double shadowAlong(const Occluder& occluder, glm::vec3 direction) {
    return std::sqrt(double(glm::dot(direction, occluder.squaredShadow * direction)));
}

// On the floor that it lies on, where the horizon never cuts it, and on slopes and walls, where it does.
TEST(Occluders, ClosedFormIsExactUnderAUniformSky) {
    Scene scene;
    addSphere(scene, {0, 0.5f, 0}, 0.5f);
    const RayScene rays(scene);
    for (const glm::vec3 normal : {glm::vec3(0, 1, 0), glm::normalize(glm::vec3(0.6f, 0.8f, 0)),
                                   glm::normalize(glm::vec3(-1, 1, 0.5f)), glm::vec3(-1, 0, 0)})
        for (const float x : {0.15f, 0.3f, 0.6f, 1.0f, 2.0f}) {
            const glm::vec3 position(x, 0, 0);
            const double seen = seenSky(rays, position, normal);
            EXPECT_NEAR(1 - sphereOcclusion(glm::vec3(0, 0.5f, 0) - position, 0.5f, normal), seen,
                        0.02 * seen)
                << x << " " << normal.x;
        }
    EXPECT_EQ(sphereOcclusion({0, 0.2f, 0}, 0.5f, {0, 1, 0}), 1) << "inside it";
    EXPECT_EQ(sphereOcclusion({0, -2, 0}, 0.5f, {0, 1, 0}), 0) << "behind the surface";
}

TEST(Occluders, ASphereStandsForItself) {
    Scene scene;
    addSphere(scene, {1, 2, 3}, 0.25f);
    const std::vector<Occluder> occluders = occludersOf(scene);
    ASSERT_EQ(occluders.size(), 1u);
    EXPECT_LT(glm::distance(occluders[0].center, glm::vec3(1, 2, 3)), 0.001f);
    const double shadow = double(kPi) * 0.25 * 0.25;
    for (int i = 0; i < 20; ++i)
        EXPECT_NEAR(shadowAlong(occluders[0], spherePoint(i, 20)), shadow, 0.005 * shadow);
}

// Of its real shadow they have 1 / sqrt(3/4) less along its normal, as is said of them.
TEST(Occluders, OfAPlateAreFlatHoweverItIsTurned) {
    for (const float angle : {0.0f, 0.7f}) {
        Scene scene;
        addOutwardBox(scene, lambert(0.5f), {0, 0, 0}, {2, 0.001f, 1});
        const glm::mat3 turn(glm::rotate(glm::mat4(1), angle, glm::vec3(0, 0, 1)));
        for (glm::vec3& position : scene.positions) position = turn * position;
        const std::vector<Occluder> occluders = occludersOf(scene);
        EXPECT_GE(occluders.size(), 2u);
        double along = 0, across = 0;
        for (const Occluder& occluder : occluders) {
            along += shadowAlong(occluder, turn * glm::vec3(0, 1, 0));
            across += shadowAlong(occluder, turn * glm::vec3(0, 0, 1));
        }
        EXPECT_NEAR(along, 2 * std::sqrt(0.75), 0.01);
        EXPECT_LT(across, 0.1);
    }
}

TEST(Occluders, AreNeverTooMany) {
    Scene scene;
    for (uint32_t i = 0; i < 200; ++i) {
        addOutwardBox(scene, lambert(0.5f), {float(i % 20), 0, float(i / 20)}, {0.5f, 0.2f, 0.1f});
        for (size_t s = 6 * size_t(i); s < scene.surfaces.size(); ++s) scene.surfaces[s].node = i;
        const size_t count = occludersOf(scene).size();
        EXPECT_GT(count, 0u);
        EXPECT_LE(count, kMaxOccluders);
    }
    scene.materials.assign(scene.materials.size(), Material());
    for (Material& material : scene.materials) material.alphaMode = AlphaMode::blend;
    EXPECT_TRUE(occludersOf(scene).empty());
}

// A table of a plate and four legs.
TEST(Occluders, OfATableShadeTheFloorAboutAsItDoes) {
    Scene scene;
    const Material wood = lambert(0);
    uint32_t node = 0;
    const auto add = [&](glm::vec3 low, glm::vec3 size) {
        const size_t first = scene.surfaces.size();
        addOutwardBox(scene, wood, low, size);
        for (size_t s = first; s < scene.surfaces.size(); ++s) scene.surfaces[s].node = node;
        ++node;
    };
    add({-0.6f, 0.7f, -0.4f}, {1.2f, 0.05f, 0.8f});
    for (const glm::vec2 at : {glm::vec2(-0.6f, -0.4f), {0.54f, -0.4f}, {-0.6f, 0.34f}, {0.54f, 0.34f}})
        add({at.x, 0, at.y}, {0.06f, 0.7f, 0.06f});
    const RayScene rays(scene);
    const std::vector<Occluder> occluders = occludersOf(scene);
    double error = 0, shade = 0;
    for (int i = 0; i < 64; ++i) {
        const glm::vec3 position(-1.1f + 0.3f * float(i % 8), 0, -0.9f + 0.25f * float(i / 8));
        const double seen = seenSky(rays, position, {0, 1, 0});
        error += std::abs(leftBy(occluders, position, {0, 1, 0}) - seen) / 64;
        shade += (1 - seen) / 64;
    }

    // Measured: .15 of it. What is missing is that plates are 13 % too small, and that occluders are round.
    EXPECT_LT(error, 0.2 * shade);
}

}  // namespace
}  // namespace phat
