// Where walls divide surfaces, and what the cut leaves of a mesh.

#include "core/atlas/divided_surfaces.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/atlas/atlas_checks.h"
#include "core/base/random.h"
#include "support/divided_rooms.h"
#include "support/scene_parts.h"

namespace phat {
namespace {

using namespace test;

constexpr double kTexel = 0.05;

// The areas of the parts of surface 0, the one around the origin first; a single one if it is whole.
std::vector<double> floorParts(const Scene& scene, double texelSize = kTexel) {
    const std::vector<DividedSurface> divided = divideAtWalls(RayScene(scene), texelSize);
    const Scene parts = withParts(scene, divided);
    std::vector<double> areas;
    const uint32_t count = !divided.empty() && divided[0].surface == 0 ? divided[0].partCount : 1;
    for (uint32_t part = 0; part < count; ++part) {
        double area = 0;
        bool around = false;
        const Surface& surface = parts.surfaces[part];
        for (uint32_t t = surface.firstTriangle; t < surface.firstTriangle + surface.triangleCount; ++t) {
            area += areaOf(parts, t);
            const glm::uvec3 v = parts.triangles[t];
            const auto side = [&](int i) {
                const glm::vec3 a = parts.positions[v[i]], b = parts.positions[v[(i + 1) % 3]];
                return a.x * b.z - a.z * b.x;
            };
            const float x = side(0), y = side(1), z = side(2);
            around = around || std::min({x, y, z}) >= 0 || std::max({x, y, z}) <= 0;
        }
        areas.insert(around ? areas.begin() : areas.end(), area);
    }
    return areas;
}

void expectRoomOf(const std::vector<double>& parts, double floorArea) {
    ASSERT_EQ(parts.size(), 2u) << parts[1] << ' ' << parts[2];
    // What is under the walls, 2.04 x 2.04 m at their outer sides, belongs to either side.
    EXPECT_GE(parts[0], 2.0 * 2.0 - 1e-3);
    EXPECT_LE(parts[0], 2.04 * 2.04 + 1e-3);
    EXPECT_NEAR(parts[0] + parts[1], floorArea, 1e-3 * floorArea);
}

TEST(DividedSurfaces, AClosedRoomPartsTheFloorUnderIt) {
    expectRoomOf(floorParts(roomOnFloor()), 36);
}

TEST(DividedSurfaces, WallsMayEndOnTheFloorOrJustAboveIt) {
    expectRoomOf(floorParts(roomOnFloor({.foot = 0})), 36);
    expectRoomOf(floorParts(roomOnFloor({.foot = 0.002f})), 36);
}

TEST(DividedSurfaces, AFloorThatEndsSoonBehindTheWallsIsDividedToo) {
    expectRoomOf(floorParts(roomOnFloor({.floor = 2.14f})), 2.14 * 2.14);
}

TEST(DividedSurfaces, ADoorwayKeepsAFloorWhole) {
    EXPECT_EQ(floorParts(roomOnFloor({.doorway = 0.8f})).size(), 1u);
}

TEST(DividedSurfaces, WallsHighAboveAFloorDoNotDivideIt) {
    EXPECT_EQ(floorParts(roomOnFloor({.foot = 0.2f})).size(), 1u);
}

TEST(DividedSurfaces, ObjectsOnAFloorDoNotDivideIt) {
    Scene scene;
    addRoom(scene, lambert(0.5f), {4, 3, 4});
    addOutwardBox(scene, lambert(0.5f), {1, 0, 1}, {1, 1, 1});
    addOutwardBox(scene, lambert(0.5f), {2.5f, -0.1f, 1}, {0.1f, 1.1f, 0.1f});
    // Only the second box has a part below the floor.
    for (const DividedSurface& divided : divideAtWalls(RayScene(scene), kTexel))
        EXPECT_GE(divided.surface, 12u);
}

// Its one row of texels would lie at the border of the hidden half.
TEST(DividedSurfaces, AHalfHiddenStripNarrowerThanATexelIsDivided) {
    Scene scene;
    const auto firstOf = [&](glm::vec3 corner, glm::vec3 size) {
        const size_t first = scene.surfaces.size();
        addOutwardBox(scene, lambert(0.5f), corner, size);
        return first;
    };
    firstOf({0, 0, 0}, {1, 0.04f, 0.3f});                               // a tread
    const size_t riser = firstOf({0, 0.04f, 0.29f}, {1, 0.2f, 0.02f});  // behind it for half its thickness
    std::vector<uint32_t> parts;
    for (const DividedSurface& divided : divideAtWalls(RayScene(scene), kTexel))
        if (divided.surface >= riser && divided.partCount > 1) parts.push_back(divided.partCount);
    EXPECT_EQ(parts, std::vector<uint32_t>{2});
}

TEST(DividedSurfaces, BoardsDoNotShatterTheScreedUnderThem) {
    Scene scene = roomOnFloor();
    constexpr int kRows = 40;
    const float side = 8.0f / kRows;
    addFloor(scene, lambert(0.5f), 8, -1);
    const uint32_t screed = uint32_t(scene.surfaces.size() - 1);
    for (int y = 0; y < kRows; ++y)
        for (int x = 0; x < kRows; ++x)
            addOutwardBox(scene, lambert(0.5f), {-4 + side * float(x), -1, -4 + side * float(y)},
                          {side - 0.01f, 0.02f, side - 0.01f});
    bool floor = false;
    for (const DividedSurface& divided : divideAtWalls(RayScene(scene), kTexel)) {
        floor = floor || divided.surface == 0;
        EXPECT_NE(divided.surface, screed);
    }
    EXPECT_TRUE(floor) << "what is beside the boards is divided as ever";
}

TEST(DividedSurfaces, HundredsOfRoomsDivideTheirFloor) {
    constexpr int kRooms = 20;
    Scene scene;
    size_t large = 0;
    addFloor(scene, lambert(0.5f), kRooms);
    for (int i = 0; i <= kRooms; ++i) {
        const float at = float(i) - 0.5f * kRooms, half = 0.5f * kRooms;
        addOutwardBox(scene, lambert(0.5f), {at - 0.02f, -0.1f, -half}, {0.04f, 1, kRooms});
        addOutwardBox(scene, lambert(0.5f), {-half, -0.1f, at - 0.02f}, {kRooms, 1, 0.04f});
    }
    const Scene parts = withParts(scene, divideAtWalls(RayScene(scene), kTexel));
    double area = 0;
    for (uint32_t t = 0; t < parts.triangles.size(); ++t) {
        const Surface& surface = parts.surfaces[parts.triangleSurface[t]];
        if (surface.material != 0) continue;
        area += areaOf(parts, t);
        if (areaOf(parts, t) < 0.03) continue;  // under a wall
        glm::vec3 low(1e30f), high(-1e30f);
        for (int i = 0; i < 3; ++i) {
            low = glm::min(low, parts.positions[parts.triangles[t][i]]);
            high = glm::max(high, parts.positions[parts.triangles[t][i]]);
        }
        EXPECT_LT(std::max(high.x - low.x, high.z - low.z), 1.1f) << "a triangle is in two rooms";
        ++large;
    }
    EXPECT_GE(large, size_t(kRooms) * kRooms);
    EXPECT_NEAR(area, kRooms * kRooms, 1e-3 * kRooms * kRooms);
}

TEST(DividedSurfaces, GlassAndWhatMovesAreNoWalls) {
    Scene glazed = roomOnFloor();
    for (size_t m = 1; m < glazed.materials.size(); ++m) glazed.materials[m].transmission = 1;
    EXPECT_EQ(floorParts(glazed).size(), 1u);

    Scene moving = roomOnFloor();
    moving.nodes.resize(3);
    moving.nodes[2].parent = 1;
    moving.animations.emplace_back().channels.emplace_back().node = 1;
    for (size_t s = 1; s < moving.surfaces.size(); ++s) moving.surfaces[s].node = 2;
    EXPECT_EQ(floorParts(moving).size(), 1u);
}

TEST(DividedSurfaces, APartIsTheSameInMillimetres) {
    Scene scene = roomOnFloor();
    for (glm::vec3& p : scene.positions) p *= 1000.0f;
    const std::vector<double> parts = floorParts(scene, 1000 * kTexel);
    ASSERT_EQ(parts.size(), 2u);
    EXPECT_NEAR(parts[0] + parts[1], 36e6, 36e3);
}

TEST(DividedSurfaces, OfOneMeshTooAndWithAWallAlongItsEdges) {
    // Two rooms side by side, floor and partition in one surface, and the floor has an edge under it.
    Scene scene;
    addRoom(scene, lambert(0.5f), {4, 2, 2});
    addSurface(scene, lambert(0.5f));
    const auto quad = [&](glm::vec3 corner, glm::vec3 along, glm::vec3 across) {
        const glm::vec3 a[] = {corner, corner + along, corner + along + across};
        const glm::vec3 b[] = {corner, corner + along + across, corner + across};
        const glm::vec2 uv[] = {{0, 0}, {1, 0}, {1, 1}};
        addTriangle(scene, a, uv);
        addTriangle(scene, b, uv);
    };
    quad({0, 0.1f, 0}, {0, 0, 2}, {2, 0, 0});
    quad({2, 0.1f, 0}, {0, 0, 2}, {2, 0, 0});
    quad({2, 0.1f, 0}, {0, 2, 0}, {0, 0, 2});
    quad({2, 0.1f, 0}, {0, 0, 2}, {0, 2, 0});
    const std::vector<DividedSurface> divided = divideAtWalls(RayScene(scene), kTexel);
    const auto raised =
        std::find_if(divided.begin(), divided.end(), [](const DividedSurface& d) { return d.surface == 6; });
    ASSERT_NE(raised, divided.end());
    const Scene parts = withParts(scene, divided);
    // No part of the raised floor has triangles on both sides of the partition.
    for (const Surface& surface : parts.surfaces) {
        if (surface.material != 6) continue;
        bool left = false, right = false;
        for (uint32_t t = surface.firstTriangle; t < surface.firstTriangle + surface.triangleCount; ++t)
            for (int i = 0; i < 3; ++i) {
                left = left || parts.positions[parts.triangles[t][i]].x < 1.9f;
                right = right || parts.positions[parts.triangles[t][i]].x > 2.1f;
            }
        EXPECT_FALSE(left && right);
    }
}

TEST(DividedSurfaces, AttributesAreThoseOfTheUncutTriangles) {
    Scene scene = roomOnFloor();
    // Of the floor: uv is a function of the position.
    for (uint32_t v = 0; v < scene.surfaces[0].vertexCount; ++v) {
        const glm::vec3 p = scene.positions[v];
        scene.uv0[v] = {0.3f * p.x + 0.1f * p.z, 0.2f * p.z};
        scene.colors[v] = glm::vec4(0.5f + 0.1f * p.x, 0.5f, 0.5f - 0.1f * p.z, 1);
    }
    const Scene parts = withParts(scene, divideAtWalls(RayScene(scene), kTexel));
    ASSERT_GT(parts.surfaces.size(), scene.surfaces.size());
    for (uint32_t v = 0; v < parts.surfaces[1].firstVertex + parts.surfaces[1].vertexCount; ++v) {
        const glm::vec3 p = parts.positions[v];
        EXPECT_NEAR(parts.uv0[v].x, 0.3f * p.x + 0.1f * p.z, 1e-5f);
        EXPECT_NEAR(parts.colors[v].b, 0.5f - 0.1f * p.z, 1e-5f);
        EXPECT_NEAR(glm::length(parts.normals[v]), 1, 1e-5f);
        EXPECT_NEAR(p.y, 0, 1e-6f);
    }
}

// A mesh of triangles that is cut along random lines.
class CutMesh : public ::testing::Test {
  protected:
    static constexpr int kCells = 4;
    static constexpr double kTolerance = 1e-5;

    CutMesh() {
        addSurface(scene_, lambert(0.5f));
        for (int y = 0; y < kCells; ++y)
            for (int x = 0; x < kCells; ++x) {
                const glm::vec3 p(float(x), 0, float(y));
                const glm::vec3 a[] = {p, p + glm::vec3(0, 0, 1), p + glm::vec3(1, 0, 1)};
                const glm::vec3 b[] = {p, p + glm::vec3(1, 0, 1), p + glm::vec3(1, 0, 0)};
                const glm::vec2 uv[] = {{0, 0}, {1, 0}, {1, 1}};
                addTriangle(scene_, a, uv);
                addTriangle(scene_, b, uv);
            }
    }

    // A random line from edge to edge of a triangle, or within it.
    WallSection section(Rng& rng) const {
        WallSection section;
        section.triangle = uint32_t(rng.uniform() * float(scene_.triangles.size()));
        const glm::uvec3 v = scene_.triangles[section.triangle];
        for (glm::dvec3* end : {&section.from, &section.to}) {
            glm::dvec2 b = rng.uniform2();
            if (b.x + b.y > 1) b = 1.0 - b;
            if (rng.uniform() < 0.3f) b.x = 0;
            *end = (1 - b.x - b.y) * glm::dvec3(scene_.positions[v[0]]) +
                   b.x * glm::dvec3(scene_.positions[v[1]]) + b.y * glm::dvec3(scene_.positions[v[2]]);
        }
        return section;
    }

    Scene scene_;
};

TEST_F(CutMesh, AreaStaysAndEdgesMatch) {
    const MeshTopology topology = buildTopology(scene_);
    MeshCutter cutter(scene_, topology, kTolerance);
    Rng rng(5);
    for (uint32_t i = 0; i < 200; ++i) cutter.cut(section(rng), i);
    ASSERT_GT(cutter.triangles().size(), 400u);
    double area = 0;
    std::vector<double> areaOfOrigin(scene_.triangles.size(), 0);
    for (uint32_t t = 0; t < cutter.triangles().size(); ++t) {
        const glm::uvec3 v = cutter.triangles()[t];
        const glm::dvec3 cross = glm::cross(cutter.position(v[1]) - cutter.position(v[0]),
                                            cutter.position(v[2]) - cutter.position(v[0]));
        EXPECT_GT(cross.y, -1e-7) << "a triangle turned over";
        area += 0.5 * cross.y;
        areaOfOrigin[cutter.origin(t)] += 0.5 * cross.y;
    }
    EXPECT_NEAR(area, kCells * kCells, 1e-4);
    for (const double own : areaOfOrigin) EXPECT_NEAR(own, 0.5, 1e-4);

    // Every edge within the mesh has a triangle on either side.
    double border = 0;
    for (const auto& [edge, users] : cutter.edges()) {
        if (users.empty()) continue;
        ASSERT_LE(users.size(), 2u);
        if (users.size() == 1)
            border += glm::distance(cutter.position(uint32_t(edge >> 32)), cutter.position(uint32_t(edge)));
    }
    EXPECT_NEAR(border, 4 * kCells, 1e-3);
}

TEST_F(CutMesh, LinesBecomeEdges) {
    const MeshTopology topology = buildTopology(scene_);
    MeshCutter cutter(scene_, topology, kTolerance);
    Rng rng(6);
    std::vector<WallSection> sections;
    for (uint32_t i = 0; i < 100; ++i) {
        sections.push_back(section(rng));
        cutter.cut(sections.back(), i);
    }
    std::vector<double> covered(sections.size(), 0);
    for (const auto& [edge, users] : cutter.edges()) {
        const std::vector<uint32_t>* numbers = cutter.sectionsOf(edge);
        if (!numbers || users.empty()) continue;
        for (const uint32_t number : *numbers)
            covered[number] +=
                glm::distance(cutter.position(uint32_t(edge >> 32)), cutter.position(uint32_t(edge)));
    }
    for (size_t i = 0; i < sections.size(); ++i)
        EXPECT_NEAR(covered[i], glm::distance(sections[i].from, sections[i].to), 1e-3) << i;
}

TEST_F(CutMesh, NewVerticesAreMeansOfOthers) {
    const MeshTopology topology = buildTopology(scene_);
    MeshCutter cutter(scene_, topology, kTolerance);
    Rng rng(7);
    for (uint32_t i = 0; i < 100; ++i) cutter.cut(section(rng), i);
    const auto added = cutter.newVertices();
    for (size_t i = 0; i < added.size(); ++i) {
        glm::dvec3 mean(0);
        for (int k = 0; k < 3; ++k) mean += added[i].weight[k] * cutter.position(added[i].from[k]);
        EXPECT_LT(glm::distance(mean, cutter.position(uint32_t(scene_.positions.size() + i))), 1e-5);
    }
}

}  // namespace
}  // namespace phat
