// Charts cut so that the boxes around the parts are small.

#include "core/atlas/box_parts.h"

#include <gtest/gtest.h>

#include <numeric>

#include "core/atlas/atlas_checks.h"
#include "core/atlas/atlas_shapes.h"
#include "core/atlas/unwrap_flatten.h"
#include "core/atlas/unwrap_grow.h"

namespace phat {
namespace {

constexpr double kTexel = 0.02;

/// A planar scene of one connected piece as a flat chart.
FlatChart flatOf(const Scene& scene) {
    FlatChart flat;
    flat.triangles.resize(scene.triangles.size());
    std::iota(flat.triangles.begin(), flat.triangles.end(), 0u);
    std::vector<glm::dvec2> positions;
    for (const glm::vec3& p : scene.positions) positions.push_back(glm::dvec2(p));
    flat.sizeMeters = alignToBox(positions);
    for (const glm::uvec3& t : scene.triangles)
        flat.uvMeters.push_back({positions[t.x], positions[t.y], positions[t.z]});
    for (uint32_t t = 0; t < scene.triangles.size(); ++t) flat.area += areaOf(scene, t);
    return flat;
}

/// A square frame around a square hole, of eight triangles that reach from corner to corner.
Scene frame(float side, float width) {
    Scene scene;
    const float a = width, b = side - width;
    shapes::add(
        scene,
        {{0, 0, 0}, {side, 0, 0}, {side, side, 0}, {0, side, 0}, {a, a, 0}, {b, a, 0}, {b, b, 0}, {a, b, 0}},
        {{0, 1, 4}, {1, 5, 4}, {1, 2, 5}, {2, 6, 5}, {2, 3, 6}, {3, 7, 6}, {3, 0, 7}, {0, 4, 7}});
    return scene;
}

std::vector<std::vector<uint32_t>> partsOf(const Scene& scene, const FlatChart& flat) {
    return partsWithSmallBoxes(buildTopology(scene), flat, kTexel);
}

double boxesArea(const FlatChart& flat, const std::vector<std::vector<uint32_t>>& parts) {
    double area = 0;
    for (const std::vector<uint32_t>& part : parts) {
        std::vector<glm::dvec2> corners;
        for (const uint32_t t : part)
            corners.insert(corners.end(), flat.uvMeters[t].begin(), flat.uvMeters[t].end());
        const glm::dvec2 size = alignToBox(corners);
        area += size.x * size.y;
    }
    return area;
}

TEST(BoxParts, AFrameFallsIntoFourBars) {
    const Scene scene = frame(6, 0.4f);
    const FlatChart flat = flatOf(scene);
    const auto parts = partsOf(scene, flat);
    EXPECT_EQ(parts.size(), 4u);
    // Four bars of 6 m x .4 m, which meet in mitres.
    EXPECT_NEAR(boxesArea(flat, parts), 4 * 6 * 0.4, 0.01);
}

TEST(BoxParts, PartsHangTogetherAndHoldEveryTriangleOnce) {
    Scene scene;  // a snake of three arcs, .2 m wide
    shapes::addGrid(scene, 90, 2, [](float u, float v) {
        const int arc = std::min(int(3 * u), 2);
        const float turn = kPi * (3 * u - float(arc)), r = 1 + 0.2f * (arc == 1 ? v - 0.5f : 0.5f - v);
        return glm::vec3(2 * float(arc) - r * std::cos(turn), (arc == 1 ? -r : r) * std::sin(turn), 0);
    });
    const FlatChart flat = flatOf(scene);
    const MeshTopology topology = buildTopology(scene);
    const auto parts = partsWithSmallBoxes(topology, flat, kTexel);
    EXPECT_GT(parts.size(), 4u);
    EXPECT_LT(parts.size(), 40u);
    EXPECT_LT(boxesArea(flat, parts), 0.5 * flat.sizeMeters.x * flat.sizeMeters.y);
    std::vector<uint32_t> all;
    for (const std::vector<uint32_t>& part : parts) {
        EXPECT_TRUE(std::is_sorted(part.begin(), part.end()));
        EXPECT_EQ(connectedPieces(topology, part).size(), 1u);
        all.insert(all.end(), part.begin(), part.end());
    }
    std::sort(all.begin(), all.end());
    EXPECT_EQ(all, flat.triangles);
}

TEST(BoxParts, WhatFillsItsBoxStaysWhole) {
    for (const Scene& scene : {shapes::plane(3, 2, 12), shapes::plane(30, 0.01f, 6)})
        EXPECT_EQ(partsOf(scene, flatOf(scene)).size(), 1u);
    // Next to no hole: bars are less than the whole, and four of them more.
    EXPECT_EQ(partsOf(frame(6, 2.9f), flatOf(frame(6, 2.9f))).size(), 1u);
}

}  // namespace
}  // namespace phat
