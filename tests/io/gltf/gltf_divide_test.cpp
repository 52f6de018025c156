// Surfaces that walls divide, as primitives of the file.

#include <gtest/gtest.h>

#include "io/gltf/gltf_built.h"

namespace phat {
namespace {

using test::GltfBuilder;
using Json = nlohmann::json;

constexpr float kFloor = 6;  // side of the floors

// A floor around the origin whose uv and colour follow from the position, colours as bytes.
int floorMesh(GltfBuilder& builder) {
    constexpr float h = kFloor / 2;
    const std::vector<float> uv = {0, 0, 0, 1, 1, 1, 1, 0};
    const std::vector<uint8_t> colors = {0,   0,   255, 255, 0,   255, 255, 255,
                                         255, 255, 255, 255, 255, 0,   255, 255};
    return builder.mesh(
        {{"attributes",
          {{"POSITION", builder.floats("VEC3", {-h, 0, -h, -h, 0, h, h, 0, h, h, 0, -h})},
           {"NORMAL", builder.floats("VEC3", {0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0})},
           {"TEXCOORD_0", builder.floats("VEC2", uv)},
           {"COLOR_0", builder.accessor(builder.view(colors), test::kUnsignedByte, "VEC4", 4, true)}}},
         {"indices", builder.indices({0, 1, 2, 0, 2, 3})}});
}

// Four walls of no thickness, 2 m apart and 1 m high, that look inward, and a roof.
int roomMesh(GltfBuilder& builder) {
    std::vector<float> positions;
    std::vector<uint16_t> indices;
    const auto quad = [&](glm::vec3 a, glm::vec3 b, glm::vec3 c, glm::vec3 d) {
        const auto first = uint16_t(positions.size() / 3);
        for (const glm::vec3& p : {a, b, c, d})
            for (int axis = 0; axis < 3; ++axis) positions.push_back(p[axis]);
        for (const int i : {0, 1, 2, 0, 2, 3}) indices.push_back(uint16_t(first + i));
    };
    quad({-1, 0, -1}, {1, 0, -1}, {1, 1, -1}, {-1, 1, -1});
    quad({1, 0, 1}, {-1, 0, 1}, {-1, 1, 1}, {1, 1, 1});
    quad({-1, 0, 1}, {-1, 0, -1}, {-1, 1, -1}, {-1, 1, 1});
    quad({1, 0, -1}, {1, 0, 1}, {1, 1, 1}, {1, 1, -1});
    quad({-1, 1, -1}, {1, 1, -1}, {1, 1, 1}, {-1, 1, 1});
    return builder.mesh({{"attributes", {{"POSITION", builder.floats("VEC3", positions)}}},
                         {"indices", builder.indices(indices)}});
}

struct Divided {
    GltfSource source;
    Scene scene;
};

Divided divided(const GltfBuilder& builder) {
    const TemporaryFolder folder;
    writeBytes(folder.file("a.glb"), builder.glb());
    Divided result{openGltf(folder.file("a.glb")), {}};
    AtlasSettings atlas;
    atlas.texelSizeMeters = 0.05f;
    result.scene = loadGltf(result.source, {{}, atlas}).scene;
    EXPECT_EQ(test::countUnsound(result.scene), 0);
    return result;
}

double areaOf(const Scene& scene, const Surface& surface) {
    double area = 0;
    for (uint32_t t = surface.firstTriangle; t < surface.firstTriangle + surface.triangleCount; ++t) {
        const glm::uvec3 v = scene.triangles[t];
        const glm::dvec3 a = scene.positions[v.x], b = scene.positions[v.y], c = scene.positions[v.z];
        area += 0.5 * glm::length(glm::cross(b - a, c - a));
    }
    return area;
}

// Areas of the surfaces of a node, the smallest first.
std::vector<double> areasOfNode(const Scene& scene, uint32_t node) {
    std::vector<double> areas;
    for (const Surface& surface : scene.surfaces)
        if (surface.node == node) areas.push_back(areaOf(scene, surface));
    std::sort(areas.begin(), areas.end());
    return areas;
}

void expectDivided(const std::vector<double>& areas) {
    ASSERT_EQ(areas.size(), 2u);
    EXPECT_NEAR(areas[0], 4, 1e-4);
    EXPECT_NEAR(areas[1], kFloor * kFloor - 4, 1e-4);
}

TEST(GltfDivide, PartsArePrimitivesWithAllAttributes) {
    GltfBuilder builder;
    const int floor = builder.root({{"mesh", floorMesh(builder)}});
    builder.root({{"mesh", roomMesh(builder)}});
    const Divided file = divided(builder);
    expectDivided(areasOfNode(file.scene, uint32_t(floor)));
    EXPECT_EQ(file.source.json["meshes"][0]["primitives"].size(), 2u);
    for (const Surface& surface : file.scene.surfaces) {
        if (surface.node != uint32_t(floor)) continue;
        for (uint32_t v = surface.firstVertex; v < surface.firstVertex + surface.vertexCount; ++v) {
            const glm::vec3 p = file.scene.positions[v];
            const glm::vec2 uv = glm::vec2(p.x, p.z) / kFloor + 0.5f;
            EXPECT_NEAR(glm::distance(file.scene.uv0[v], uv), 0, 1e-5f);
            EXPECT_NEAR(glm::distance(file.scene.colors[v], glm::vec4(uv, 1, 1)), 0, 1e-5f);
        }
    }
}

TEST(GltfDivide, NothingChangesWhereNoWallDivides) {
    GltfBuilder builder;
    builder.root({{"mesh", floorMesh(builder)}});
    builder.root({{"mesh", roomMesh(builder)}, {"translation", {20, 0, 0}}});
    const size_t buffers = 1;
    EXPECT_EQ(divided(builder).source.buffers.size(), buffers);
}

TEST(GltfDivide, OneOfTwoNodesWithTheMesh) {
    GltfBuilder builder;
    const int mesh = floorMesh(builder);
    const int under = builder.root({{"mesh", mesh}});
    const int away = builder.root({{"mesh", mesh}, {"translation", {20, 0, 0}}});
    builder.root({{"mesh", roomMesh(builder)}});
    const Divided file = divided(builder);
    expectDivided(areasOfNode(file.scene, uint32_t(under)));
    EXPECT_EQ(areasOfNode(file.scene, uint32_t(away)).size(), 1u);
    EXPECT_NEAR(areasOfNode(file.scene, uint32_t(away))[0], kFloor * kFloor, 1e-4);
}

TEST(GltfDivide, MirroredNodesKeepTheirFronts) {
    GltfBuilder builder;
    const int floor = builder.root({{"mesh", floorMesh(builder)}, {"scale", {-1, 1, 1}}});
    builder.root({{"mesh", roomMesh(builder)}});
    const Divided file = divided(builder);
    expectDivided(areasOfNode(file.scene, uint32_t(floor)));
    for (uint32_t t = 0; t < file.scene.triangles.size(); ++t) {
        if (file.scene.surfaces[file.scene.triangleSurface[t]].node != uint32_t(floor)) continue;
        const glm::uvec3 v = file.scene.triangles[t];
        const auto& p = file.scene.positions;
        EXPECT_GT(glm::cross(p[v.y] - p[v.x], p[v.z] - p[v.x]).y, 0);
    }
}

}  // namespace
}  // namespace phat
