#include <gtest/gtest.h>

#include <chrono>
#include <cmath>

#include "core/base/stopwatch.h"
#include "io/base/file_error.h"
#include "io/gltf/gltf_built.h"
#include "support/temporary_folder.h"

namespace phat {
namespace {

using test::GltfBuilder;
using test::load;
using Json = nlohmann::json;

std::string reasonOf(const GltfBuilder& builder) {
    try {
        load(builder);
    } catch (const FileError& error) {
        return error.reason;
    }
    return "";
}

// A right triangle in the xy plane, front toward +z; `n` adds corners for strips and fans.
std::vector<float> corners(int n) {
    const std::vector<float> all = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 2, 0};
    return {all.begin(), all.begin() + 3 * n};
}

TEST(GltfMeshes, StripTurnsEverySecondTriangle) {
    GltfBuilder builder;
    builder.root({{"mesh", builder.mesh({{"attributes", {{"POSITION", builder.floats("VEC3", corners(5))}}},
                                         {"mode", 5}})}});
    const Scene scene = load(builder).scene;
    ASSERT_EQ(scene.triangles.size(), 3u);
    for (size_t t = 0; t < 3; ++t) {
        EXPECT_EQ(test::faceNormal(scene, t), glm::vec3(0, 0, 1)) << t;
        EXPECT_EQ(scene.normals[scene.triangles[t][0]], glm::vec3(0, 0, 1)) << t;
    }
}

TEST(GltfMeshes, IndexedFanSharesItsFirstCorner) {
    GltfBuilder builder;
    const int positions = builder.floats("VEC3", {9, 9, 9, 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0});
    const int normals = builder.floats("VEC3", {0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1});
    builder.root({{"mesh", builder.mesh({{"attributes", {{"POSITION", positions}, {"NORMAL", normals}}},
                                         {"indices", builder.indices({1, 2, 3, 4})},
                                         {"mode", 6}})}});
    const Scene scene = load(builder).scene;
    ASSERT_EQ(scene.triangles.size(), 2u);
    float area = 0;
    for (const glm::uvec3& t : scene.triangles) {
        EXPECT_TRUE(t[0] == 1 || t[1] == 1 || t[2] == 1);
        area += 0.5f * glm::cross(scene.positions[t[1]] - scene.positions[t[0]],
                                  scene.positions[t[2]] - scene.positions[t[0]])
                           .z;
    }
    EXPECT_FLOAT_EQ(area, 1.0f);  // signed: both are counter-clockwise and they do not overlap
}

TEST(GltfMeshes, WithoutNormalsEveryTriangleIsFlatAndOwnsItsVertices) {
    GltfBuilder builder;
    // Two triangles folded along a shared edge.
    const int positions = builder.floats("VEC3", {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1});
    builder.root({{"mesh", builder.mesh({{"attributes", {{"POSITION", positions}}},
                                         {"indices", builder.indices({0, 1, 2, 0, 2, 3})}})}});
    const Scene scene = load(builder).scene;
    ASSERT_EQ(scene.positions.size(), 6u);
    for (size_t t = 0; t < 2; ++t)
        for (int corner = 0; corner < 3; ++corner)
            EXPECT_EQ(scene.normals[scene.triangles[t][corner]], test::faceNormal(scene, t));
    EXPECT_EQ(test::faceNormal(scene, 0), glm::vec3(0, 0, 1));
    EXPECT_EQ(test::faceNormal(scene, 1), glm::vec3(1, 0, 0));
}

TEST(GltfMeshes, MirroredNodesKeepTheirFronts) {
    for (const Json& scale : {Json{-1, 1, 1}, Json{2, -3, 1}, Json{-1, -1, -1}, Json{1, -1, -1}}) {
        GltfBuilder builder;
        const int positions = builder.floats("VEC3", {0, 0, 0, 1, 0, 0, 0, 1, 1});
        builder.root(
            {{"scale", scale},
             {"mesh",
              builder.mesh({{"attributes",
                             {{"POSITION", positions},
                              {"NORMAL", builder.floats("VEC3", {0, -1, 1, 0, -1, 1, 0, -1, 1})}}}})}});
        const Scene scene = load(builder).scene;
        ASSERT_EQ(scene.triangles.size(), 1u);
        const float cosine = glm::dot(test::faceNormal(scene, 0), scene.normals[0]);
        EXPECT_NEAR(cosine, 1, 1e-5f) << scale;
    }
}

TEST(GltfMeshes, SkewedNodesKeepNormalsOrthogonal) {
    GltfBuilder builder;
    const int positions = builder.floats("VEC3", {0, 0, 0, 1, 0, 0, 0, 1, 0});
    // z += x / 2, y scaled by 4: not a rotation and scale, columns first.
    builder.root(
        {{"matrix", {1, 0, 0.5, 0, 0, 4, 0, 0, 0, 0, 1, 0, 5, 6, 7, 1}},
         {"mesh", builder.mesh({{"attributes",
                                 {{"POSITION", positions},
                                  {"NORMAL", builder.floats("VEC3", {0, 0, 1, 0, 0, 1, 0, 0, 1})}}}})}});
    const Scene scene = load(builder).scene;
    EXPECT_EQ(scene.positions[1], glm::vec3(6, 6, 7.5f));
    EXPECT_EQ(scene.positions[2], glm::vec3(5, 10, 7));
    EXPECT_NEAR(glm::distance(scene.normals[0], glm::normalize(glm::vec3(-0.5f, 0, 1))), 0, 1e-6f);
}

TEST(GltfMeshes, InstancesFollowTheirParents) {
    GltfBuilder builder;
    const int mesh = builder.mesh({{"attributes", {{"POSITION", builder.floats("VEC3", corners(3))}}}});
    const int child = builder.push("nodes", {{"mesh", mesh}, {"translation", {0, 0, 1}}, {"name", "child"}});
    const double half = std::sqrt(0.5);
    builder.root({{"mesh", mesh}, {"name", "alone"}});
    builder.root({{"children", {child}}, {"rotation", {0, half, 0, half}}, {"scale", {2, 2, 2}}});
    const Scene scene = load(builder).scene;
    ASSERT_EQ(scene.surfaces.size(), 2u);
    EXPECT_EQ(scene.surfaces[0].name, "alone");
    EXPECT_EQ(scene.surfaces[1].name, "child");
    EXPECT_EQ(scene.surfaces[1].node, uint32_t(child));
    // A quarter turn about y sends z to x; the scale acts first.
    EXPECT_NEAR(glm::distance(scene.positions[scene.surfaces[1].firstVertex], glm::vec3(2, 0, 0)), 0, 1e-6f);
    EXPECT_NEAR(glm::distance(scene.positions[scene.surfaces[1].firstVertex + 1], glm::vec3(2, 0, -2)), 0,
                1e-6f);
}

TEST(GltfMeshes, SparseValuesReplaceOrFillIn) {
    for (const bool withBase : {true, false}) {
        GltfBuilder builder;
        const int base = withBase ? builder.view(corners(3)) : -1;
        const int accessor = builder.accessor(base, test::kFloat, "VEC3", 3);
        if (!withBase) builder.json["accessors"][0].erase("byteOffset");
        builder.json["accessors"][size_t(accessor)]["sparse"] = {
            {"count", 2},
            {"indices", {{"bufferView", builder.view<uint8_t>({1, 2})}, {"componentType", 5121}}},
            {"values", {{"bufferView", builder.view<float>({3, 0, 0, 0, 5, 0})}}}};
        builder.root({{"mesh", builder.mesh({{"attributes", {{"POSITION", accessor}}}})}});
        const Scene scene = load(builder).scene;
        EXPECT_EQ(scene.positions[0], glm::vec3(0));
        EXPECT_EQ(scene.positions[1], glm::vec3(3, 0, 0));
        EXPECT_EQ(scene.positions[2], glm::vec3(0, 5, 0));
    }
}

TEST(GltfMeshes, QuantisedAttributesAreNormalisedAsSpecified) {
    GltfBuilder builder;
    builder.json["extensionsUsed"] = builder.json["extensionsRequired"] = {"KHR_mesh_quantization"};
    // Rows are padded to four bytes, as the specification asks of vertex attributes.
    const int positions =
        builder.accessor(builder.view<int16_t>({-32768, 0, 0, 0, 32767, 0, 0, 0, 0, 16384, 0, 0}, 8),
                         test::kShort, "VEC3", 3, true);
    const int normals = builder.accessor(builder.view<int8_t>({0, 0, 127, 0, 0, 0, -128, 0, 127, 0, 0, 0}, 4),
                                         test::kByte, "VEC3", 3, true);
    const int uv = builder.accessor(builder.view<uint16_t>({0, 65535, 13107, 0, 0, 0}), test::kUnsignedShort,
                                    "VEC2", 3, true);
    const int uv1 = builder.accessor(builder.view<int8_t>({-5, 7, 0, 0, 1, 2, 0, 0, 3, 4, 0, 0}, 4),
                                     test::kByte, "VEC2", 3);
    const int colors = builder.accessor(builder.view<uint8_t>({255, 51, 0, 128, 0, 0, 0, 0, 0, 0, 0, 255}),
                                        test::kUnsignedByte, "VEC4", 3, true);
    builder.root({{"mesh", builder.mesh({{"attributes",
                                          {{"POSITION", positions},
                                           {"NORMAL", normals},
                                           {"TEXCOORD_0", uv},
                                           {"TEXCOORD_1", uv1},
                                           {"COLOR_0", colors}}}})}});
    const Scene scene = load(builder).scene;
    EXPECT_EQ(scene.positions[0], glm::vec3(-1, 0, 0));  // -32768 clamps
    EXPECT_EQ(scene.positions[1], glm::vec3(1, 0, 0));
    EXPECT_FLOAT_EQ(scene.positions[2].y, 16384.0f / 32767.0f);
    EXPECT_EQ(scene.normals[1], glm::vec3(0, 0, -1));
    EXPECT_EQ(scene.normals[2], glm::vec3(1, 0, 0));
    EXPECT_EQ(scene.uv0[0], glm::vec2(0, 1));
    EXPECT_FLOAT_EQ(scene.uv0[1].x, 0.2f);
    EXPECT_EQ(scene.uv1[0], glm::vec2(-5, 7));
    EXPECT_EQ(scene.uv1[2], glm::vec2(3, 4));
    EXPECT_NEAR(glm::distance(scene.colors[0], glm::vec4(1, 0.2f, 0, 128.0f / 255)), 0, 1e-6f);
}

TEST(GltfMeshes, UnnormalisedIntegerPositionsAreMetres) {
    GltfBuilder builder;
    const int positions =
        builder.accessor(builder.view<uint16_t>({0, 0, 0, 0, 300, 0, 0, 0, 0, 65535, 0, 0}, 8),
                         test::kUnsignedShort, "VEC3", 3);
    builder.root({{"mesh", builder.mesh({{"attributes", {{"POSITION", positions}}}})}});
    const Scene scene = load(builder).scene;
    EXPECT_EQ(scene.positions[1], glm::vec3(300, 0, 0));
    EXPECT_EQ(scene.positions[2], glm::vec3(0, 65535, 0));
}

TEST(GltfMeshes, InterleavedAttributesAndAllIndexTypes) {
    // position, uv, colour (vec3) in rows of 32 bytes
    const std::vector<float> rows = {0, 0, 0, .1f, .2f, 1, 0, 0, 1, 0, 0, .3f, .4f, 0, 1, 0,
                                     0, 1, 0, .5f, .6f, 0, 0, 1, 7, 7, 7, 0,   0,   0, 0, 0};
    for (const int type : {5121, 5123, 5125}) {
        GltfBuilder builder;
        const int view = builder.view(rows, 32);
        const int indexView = type == 5121   ? builder.view<uint8_t>({0, 1, 2})
                              : type == 5123 ? builder.view<uint16_t>({0, 1, 2})
                                             : builder.view<uint32_t>({0, 1, 2});
        builder.root(
            {{"mesh",
              builder.mesh({{"attributes",
                             {{"POSITION", builder.accessor(view, test::kFloat, "VEC3", 4)},
                              {"NORMAL", builder.accessor(view, test::kFloat, "VEC3", 4, false, 20)},
                              {"TEXCOORD_0", builder.accessor(view, test::kFloat, "VEC2", 4, false, 12)},
                              {"COLOR_0", builder.accessor(view, test::kFloat, "VEC3", 4, false, 20)}}},
                            {"indices", builder.accessor(indexView, type, "SCALAR", 3)}})}});
        const Scene scene = load(builder).scene;
        ASSERT_EQ(scene.triangles.size(), 1u);
        EXPECT_EQ(scene.triangles[0], glm::uvec3(0, 1, 2));
        EXPECT_EQ(scene.positions[2], glm::vec3(0, 1, 0));
        EXPECT_EQ(scene.uv0[1], glm::vec2(.3f, .4f));
        EXPECT_EQ(scene.colors[2], glm::vec4(0, 0, 1, 1));
        EXPECT_EQ(scene.colors[0], glm::vec4(1, 0, 0, 1));
    }
}

TEST(GltfMeshes, PointsAndLinesAreCountedInOneLine) {
    GltfBuilder builder;
    const int positions = builder.floats("VEC3", corners(4));
    for (const int mode : {0, 1, 2, 3})
        builder.root({{"mesh", builder.mesh({{"attributes", {{"POSITION", positions}}}, {"mode", mode}})}});
    const LoadedScene loaded = load(builder);
    EXPECT_TRUE(loaded.scene.triangles.empty());
    ASSERT_EQ(loaded.notes.size(), 1u);
    EXPECT_NE(loaded.notes[0].find("4 primitives of points or lines"), std::string::npos);
}

TEST(GltfMeshes, NotANumberDropsOnlyItsTriangles) {
    GltfBuilder builder;
    std::vector<float> positions = corners(5);
    positions[12] = NAN;
    builder.root({{"mesh", builder.mesh({{"attributes", {{"POSITION", builder.floats("VEC3", positions)}}},
                                         {"mode", 5}})}});
    const LoadedScene loaded = load(builder);
    EXPECT_EQ(loaded.scene.triangles.size(), 2u);
    ASSERT_EQ(loaded.notes.size(), 1u);
    EXPECT_EQ(loaded.notes[0].substr(0, 22), "1 triangle was dropped");
}

TEST(GltfMeshes, UnusableNormalsComeFromTheTriangles) {
    GltfBuilder builder;
    const int normals = builder.floats("VEC3", {0, 0, 0, NAN, 0, 1, 0, 0, 5});
    builder.root(
        {{"mesh",
          builder.mesh(
              {{"attributes", {{"POSITION", builder.floats("VEC3", corners(3))}, {"NORMAL", normals}}}})}});
    const LoadedScene loaded = load(builder);
    for (const glm::vec3& normal : loaded.scene.normals) EXPECT_EQ(normal, glm::vec3(0, 0, 1));
    ASSERT_EQ(loaded.notes.size(), 1u);
    EXPECT_EQ(loaded.notes[0].substr(0, 16), "2 vertex normals");
}

TEST(GltfMeshes, HugeClaimsAreRefusedBeforeAllocation) {
    // 2^31 zero positions need no data at all by the specification.
    GltfBuilder zeros;
    const int accessor = zeros.accessor(-1, test::kFloat, "VEC3", size_t(1) << 31);
    zeros.root({{"mesh", zeros.mesh({{"attributes", {{"POSITION", accessor}}}})}});
    EXPECT_NE(reasonOf(zeros).find("out of proportion"), std::string::npos);

    // 20,000 instances of 20,000 triangles.
    GltfBuilder instances;
    const int positions = instances.floats("VEC3", std::vector<float>(60000 * 3));
    const int mesh = instances.mesh({{"attributes", {{"POSITION", positions}}}});
    for (int i = 0; i < 20000; ++i) instances.root({{"mesh", mesh}});
    EXPECT_NE(reasonOf(instances).find("out of proportion"), std::string::npos);

    // Tiny objects that become large structs.
    GltfBuilder materials;
    materials.json["materials"] = Json(std::vector<Json>(300000, Json::object()));
    EXPECT_NE(reasonOf(materials).find("out of proportion"), std::string::npos);
}

TEST(GltfMeshes, NodesMustFormAForest) {
    GltfBuilder twoParents;
    const int leaf = twoParents.push("nodes", Json::object());
    twoParents.root({{"children", {leaf}}});
    twoParents.root({{"children", {leaf}}});
    EXPECT_EQ(reasonOf(twoParents), "node 0 has two parents");

    GltfBuilder cycle;
    cycle.root({{"children", {1}}});
    cycle.push("nodes", {{"children", {0}}});
    EXPECT_NE(reasonOf(cycle).find("cycle"), std::string::npos);
}

TEST(GltfMeshes, ManyNodesOfManyEmptyPrimitivesAreNotPaired) {
    GltfBuilder builder;
    // 4e8 pairs of nodes and primitives.
    builder.json["meshes"] = Json::array(
        {{{"primitives", std::vector<Json>(20000, {{"attributes", Json::object()}, {"mode", 0}})}}});
    builder.json["nodes"] = std::vector<Json>(20000, {{"mesh", 0}});
    for (int i = 0; i < 20000; ++i) builder.json["scenes"][0]["nodes"].push_back(i);
    const Stopwatch start;
    EXPECT_EQ(load(builder).notes.size(), 1u);
    EXPECT_LT(start.seconds(), 100);  // a guard: within ten on a busy machine
}

TEST(GltfMeshes, DeepChainsNeedNoStack) {
    constexpr int kDepth = 100000;
    GltfBuilder builder;
    const int mesh = builder.mesh({{"attributes", {{"POSITION", builder.floats("VEC3", corners(3))}}}});
    Json nodes = Json::array();
    for (int i = 0; i + 1 < kDepth; ++i)
        nodes.push_back({{"children", {i + 1}}, {"translation", {0.25, 0, 0}}});
    nodes.push_back({{"mesh", mesh}});
    builder.json["nodes"] = nodes;
    builder.json["scenes"][0]["nodes"] = {0};
    EXPECT_EQ(load(builder).scene.positions[0], glm::vec3(0.25f * (kDepth - 1), 0, 0));
}

TEST(GltfMeshes, AMillionTrianglesLoad) {
    GltfBuilder builder;
    constexpr int kSide = 708;  // 707 * 707 * 2 triangles
    std::vector<float> positions, normals, uvs;
    std::vector<uint32_t> indices;
    for (int y = 0; y < kSide; ++y) {
        for (int x = 0; x < kSide; ++x) {
            positions.insert(positions.end(), {float(x), float(y), 0});
            normals.insert(normals.end(), {0, 0, 1});
            uvs.insert(uvs.end(), {float(x) / kSide, float(y) / kSide});
        }
    }
    for (uint32_t y = 0; y + 1 < kSide; ++y)
        for (uint32_t x = 0; x + 1 < kSide; ++x) {
            const uint32_t v = y * kSide + x;
            indices.insert(indices.end(), {v, v + 1, v + kSide, v + 1, v + kSide + 1, v + kSide});
        }
    const int indexAccessor =
        builder.accessor(builder.view(indices), test::kUnsignedInt, "SCALAR", indices.size());
    builder.root({{"mesh", builder.mesh({{"attributes",
                                          {{"POSITION", builder.floats("VEC3", positions)},
                                           {"NORMAL", builder.floats("VEC3", normals)},
                                           {"TEXCOORD_0", builder.floats("VEC2", uvs)}}},
                                         {"indices", indexAccessor}})}});
    const TemporaryFolder folder;
    writeBytes(folder.file("a.glb"), builder.glb());
    const Stopwatch start;
    const Scene scene = loadGltf(folder.file("a.glb")).scene;
    EXPECT_LT(start.seconds(), 100);  // a guard: within ten on a busy machine
    EXPECT_EQ(scene.triangles.size(), 999698u);
    EXPECT_EQ(boundsOf(scene).high, glm::vec3(707, 707, 0));
}

}  // namespace
}  // namespace phat
