// What probes store: irradiance by normal in few bytes, and how far they see.

#include "core/probes/light_probes.h"

#include <gtest/gtest.h>

#include "core/base/random.h"
#include "core/probes/probe_distances.h"
#include "core/probes/probe_sh.h"

namespace phat {
namespace {

constexpr int kDirections = 4096;
constexpr float kHidden = 2e-4f;  // weight of a probe that does not see the point

glm::vec3 randomDirection(Rng& random) {
    return spherePoint(int(random.uniform() * kDirections), kDirections);
}

template <class Radiance>
IrradianceSh irradianceOf(const Radiance& radiance) {
    IrradianceSh sum;
    for (int i = 0; i < kDirections; ++i) {
        const glm::vec3 direction = spherePoint(i, kDirections);
        sum.addLight(direction, radiance(direction) * 4.0f * kPi / float(kDirections));
    }
    return sum;
}

// E = pi L for every normal.
TEST(ProbeSh, FurnaceIsEven) {
    const glm::vec3 light(1, 2, 0.5f);
    const IrradianceSh sh = irradianceOf([&](glm::vec3) { return light; });
    for (int i = 0; i < 100; ++i) {
        const glm::vec3 e = sh.at(spherePoint(i, 100));
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(e[c], kPi * light[c], 2e-3f * light[c]);
    }
}

// Of L = 1 + g.w the irradiance is pi + 2 pi / 3 g.n.
TEST(ProbeSh, LinearLightIsExact) {
    const glm::vec3 g(0.3f, -0.5f, 0.4f);
    const IrradianceSh sh = irradianceOf([&](glm::vec3 w) { return glm::vec3(1 + glm::dot(g, w)); });
    for (int i = 0; i < 100; ++i) {
        const glm::vec3 n = spherePoint(i, 100);
        EXPECT_NEAR(sh.at(n).x, kPi + 2 * kPi / 3 * glm::dot(g, n), 5e-3f);
    }
}

// Of L = (w.a)^2 it is pi / 4 (1 + (n.a)^2), from the tensors of order 0 and 2.
TEST(ProbeSh, QuadraticLightIsExact) {
    const glm::vec3 a = glm::normalize(glm::vec3(1, 2, -0.5f));
    const IrradianceSh sh = irradianceOf([&](glm::vec3 w) { return glm::vec3(square(glm::dot(a, w))); });
    for (int i = 0; i < 100; ++i) {
        const glm::vec3 n = spherePoint(i, 100);
        EXPECT_NEAR(sh.at(n).x, kPi / 4 * (1 + square(glm::dot(n, a))), 5e-3f);
    }
}

// A lamp that fills a small cone: the clamped cosine, but for the cone's width.
TEST(ProbeSh, OneLampHasASharpTerminator) {
    const glm::vec3 toward = glm::normalize(glm::vec3(1, 3, 2));
    const float cosine = std::cos(glm::radians(10.0f));
    IrradianceSh sh;
    int inside = 0;
    constexpr int kMany = 100'000;
    for (int i = 0; i < kMany; ++i) inside += glm::dot(spherePoint(i, kMany), toward) > cosine;
    for (int i = 0; i < kMany; ++i)
        if (const glm::vec3 w = spherePoint(i, kMany); glm::dot(w, toward) > cosine)
            sh.addLight(w, glm::vec3(1.0f / float(inside)));
    double error = 0, mean = 0;
    for (int i = 0; i < 1000; ++i) {
        const glm::vec3 n = spherePoint(i, 1000);
        const float want = std::max(0.0f, glm::dot(n, toward));
        error += double(std::abs(sh.at(n).x - want));
        mean += double(want);
    }
    // .12 with the nine coefficients alone.
    EXPECT_LT(error, 0.03 * mean);
}

// Light from one direction has the largest ratios there are: half a step of each of the eight coefficients.
TEST(ProbeSh, PackingLosesLessThanAStep) {
    Rng random(1);
    for (int i = 0; i < 200; ++i) {
        IrradianceSh sh;
        const int lights = 1 + i % 3;
        for (int light = 0; light < lights; ++light)
            sh.addLight(randomDirection(random),
                        std::exp2(8 * random.uniform()) * glm::vec3(random.uniform2(), 1));
        const IrradianceSh back = unpackIrradianceSh(packIrradianceSh(sh));
        const glm::vec3 mean = sh.coefficient[0];
        // RGB9E5 is of the largest channel.
        const float ofMean = maxComponent(mean) / 512;
        for (int term = 1; term < kShTerms; ++term)
            for (int c = 0; c < 3; ++c)
                EXPECT_NEAR(back.coefficient[term][c], sh.coefficient[term][c],
                            shRatioBound(term) * (mean[c] + ofMean) * 0.51f / 127 + 3 * ofMean)
                    << "term " << term;
    }
}

ProbeDistances distancesTo(const std::vector<glm::vec4>& planes, float unit) {
    std::array<float, kDistanceNodes * kDistanceNodes> reciprocal{};
    for (int i = 0; i < int(reciprocal.size()); ++i)
        for (const glm::vec4& plane : planes)  // n.p = w
            reciprocal[size_t(i)] =
                std::max(reciprocal[size_t(i)], glm::dot(glm::vec3(plane), distanceNode(i)) / plane.w);
    return packDistances(reciprocal, unit);
}

// A wall is where it is, from whatever direction it is seen: a byte's rounding away from it.
TEST(ProbeDistances, WallsAreSharp) {
    Rng random(2);
    for (int i = 0; i < 400; ++i) {
        const glm::vec3 normal = randomDirection(random);
        const float height = 0.1f + random.uniform(), unit = 1;
        const ProbeDistances distances = distancesTo({{normal, height}}, unit);
        const glm::vec3 toward = randomDirection(random);
        const float cosine = glm::dot(normal, toward);
        if (cosine < 0.75f) continue;  // the nodes around see the wall, too
        const glm::vec3 onWall = toward * height / cosine;
        EXPECT_EQ(probeVisibility(distances, 0.99f * onWall, unit), 1.0f) << "wall " << i;
        EXPECT_LT(probeVisibility(distances, 1.2f * onWall, unit), kHidden) << "wall " << i;
        EXPECT_EQ(probeVisibility(distances, -onWall, unit), 1.0f) << "wall " << i;
    }
}

// In a box that is not along the axes nothing behind the walls is seen.
TEST(ProbeDistances, NothingBehindTheWallsOfARoomIsSeen) {
    const Frame frame = frameFromNormal(glm::normalize(glm::vec3(1, 0.7f, 0.4f)));
    const glm::vec3 half(0.3f, 0.5f, 0.8f);
    std::vector<glm::vec4> planes;
    for (int axis = 0; axis < 3; ++axis)
        for (const float sign : {1.0f, -1.0f}) {
            glm::vec3 normal(0);
            normal[axis] = sign;
            planes.emplace_back(frame.toWorld(normal), half[axis]);
        }
    const ProbeDistances distances = distancesTo(planes, 1);
    Rng random(3);
    for (int i = 0; i < 2000; ++i) {
        const glm::vec3 toward = randomDirection(random);
        float wall = kFarDistance;
        for (const glm::vec4& plane : planes)
            if (const float cosine = glm::dot(glm::vec3(plane), toward); cosine > 0)
                wall = std::min(wall, plane.w / cosine);
        EXPECT_LT(probeVisibility(distances, 1.12f * wall * toward, 1), kHidden) << "direction " << i;
    }
}

TEST(LightProbes, PlacesAreKeptToAStep) {
    Rng random(4);
    for (int i = 0; i < 100; ++i) {
        const glm::vec3 offset = 0.1f * randomDirection(random);
        const PackedPlace place = packPlace(offset, uint8_t(i), 0.5f);
        EXPECT_EQ(place >> 24, uint32_t(i));
        EXPECT_LT(glm::distance(placeOffset(place, 0.5f), offset), 0.125f / 127);
    }
}

// Two probes along x: the first is lit, the second dark, and between them there is a wall or not.
LightProbes twoProbes(const std::vector<glm::vec4>& wallOfFirst) {
    LightProbes probes;
    probes.gridSize = {1, 1, 1};
    ProbeCell cell;
    for (size_t corner = 0; corner < 8; ++corner) cell[corner] = corner % 2;
    probes.cells = {cell};
    IrradianceSh light;
    light.coefficient[0] = glm::vec3(4);
    probes.indirect = {packIrradianceSh(light), packIrradianceSh({})};
    for (const ProbeDistances& distances : {distancesTo(wallOfFirst, 1), ProbeDistances{}}) {
        probes.places.push_back(packPlace({}, distances.rangeCode, 1));
        probes.distances.push_back(distances.code);
    }
    return probes;
}

TEST(LightProbes, AreInterpolated) {
    const LightProbes probes = twoProbes({});
    ASSERT_TRUE(isConsistent(probes));
    EXPECT_NEAR(probeIrradianceAt(probes, {0.25f, 0.5f, 0.5f}, {0, 1, 0}).indirect.x, 3, 1e-4f);
    EXPECT_NEAR(probeIrradianceAt(probes, {-3, 0.5f, 0.5f}, {0, 1, 0}).indirect.x, 4, 1e-4f);
    EXPECT_EQ(probeIrradianceAt(probes, {0.25f, 0.5f, 0.5f}, {0, 1, 0}).area.x, 0);
}

// All corners of a side have the distances of the one that is at the middle of the wall's normal here.
TEST(LightProbes, DoNotShineThroughWalls) {
    const LightProbes probes = twoProbes({{1, 0, 0, 0.5f}});
    EXPECT_NEAR(probeIrradianceAt(probes, {0.45f, 0, 0}, {0, 1, 0}).indirect.x, 4 * 0.55f, 1e-3f);
    EXPECT_LT(probeIrradianceAt(probes, {0.55f, 0, 0}, {0, 1, 0}).indirect.x, 0.01f * 4);
}

TEST(LightProbes, BrokenOnesAreNoticed) {
    LightProbes probes = twoProbes({});
    probes.cells[0][3] = 2;
    EXPECT_FALSE(isConsistent(probes));
    probes = twoProbes({});
    probes.cells[0] = {kDividedCell, 0, 0};
    EXPECT_FALSE(isConsistent(probes));
    probes.cells[0] = {kDividedCell, 1, 0};
    EXPECT_FALSE(isConsistent(probes));
    probes.cells.resize(9, {0, 0, 0, 0, 1, 1, 1, 1});
    EXPECT_TRUE(isConsistent(probes));
    probes.distances.pop_back();
    EXPECT_FALSE(isConsistent(probes));
}

}  // namespace
}  // namespace phat
