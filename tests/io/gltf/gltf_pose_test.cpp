// Skins, morph targets, instances and hidden nodes: where surfaces are.

#include <gtest/gtest.h>

#include "io/base/file_error.h"
#include "io/gltf/gltf_built.h"

namespace phat {
namespace {

using test::GltfBuilder;
using test::load;
using Json = nlohmann::json;

void expectPositions(const Scene& scene, const std::vector<glm::vec3>& expected) {
    ASSERT_EQ(scene.positions.size(), expected.size());
    for (size_t i = 0; i < expected.size(); ++i)
        EXPECT_NEAR(glm::distance(scene.positions[i], expected[i]), 0, 1e-5f)
            << i << ": " << scene.positions[i].x << " " << scene.positions[i].y << " "
            << scene.positions[i].z;
}

const std::vector<float> kTriangle = {0, 0, 0, 1, 0, 0, 0, 1, 0};
const std::vector<float> kUp = {0, 0, 1, 0, 0, 1, 0, 0, 1};

// A triangle whose corners follow joint 0, joint 1 and half of each; the second half of the last corner's
// weights in a second set when `twoSets`.
GltfBuilder skinned(bool twoSets) {
    GltfBuilder builder;
    const auto joints = [&](const std::vector<uint8_t>& values) {
        return builder.accessor(builder.view(values, 4), test::kUnsignedByte, "VEC4", 3);
    };
    Json attributes = {{"POSITION", builder.floats("VEC3", kTriangle)},
                       {"NORMAL", builder.floats("VEC3", kUp)},
                       {"JOINTS_0", joints({0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0})}};
    // 8-bit weights, as exporters write: two of 127 are one but for rounding.
    const uint8_t half = twoSets ? 0 : 127;
    attributes["WEIGHTS_0"] =
        builder.accessor(builder.view<uint8_t>({255, 0, 0, 0, 255, 0, 0, 0, 127, half, 0, 0}, 4),
                         test::kUnsignedByte, "VEC4", 3, true);
    if (twoSets) {
        attributes["JOINTS_1"] = joints({0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0});
        attributes["WEIGHTS_1"] =
            builder.accessor(builder.view<uint8_t>({0, 0, 0, 0, 0, 0, 0, 0, 127, 0, 0, 0}, 4),
                             test::kUnsignedByte, "VEC4", 3, true);
    }
    const int mesh = builder.mesh({{"attributes", attributes}});
    // Joint 1 stands below joint 0; bound where each is unmoved but for (0, 0, 1).
    const int tip = builder.push("nodes", {{"translation", {0, 0, 10}}});
    builder.root({{"translation", {5, 0, 0}}, {"children", {tip}}});
    std::vector<float> bind;
    for (int j = 0; j < 2; ++j)
        for (int i = 0; i < 16; ++i) bind.push_back(i % 5 == 0 ? 1.0f : i == 14 ? -1.0f : 0.0f);
    builder.push("skins",
                 {{"joints", {1, tip}},
                  {"inverseBindMatrices", builder.accessor(builder.view(bind), test::kFloat, "MAT4", 2)}});
    const int node =
        builder.push("nodes", {{"mesh", mesh}, {"skin", 0}, {"name", "figure"}, {"scale", {9, 9, 9}}});
    builder.root({{"translation", {70, 0, 0}}, {"children", {node}}});
    return builder;
}

TEST(GltfPose, JointsPlaceASkinnedMeshAndItsNodeDoesNot) {
    for (const bool twoSets : {false, true}) {
        const LoadedScene loaded = load(skinned(twoSets));
        expectPositions(loaded.scene, {{5, 0, -1}, {6, 0, 9}, {5, 1, 4}});
        EXPECT_EQ(loaded.scene.surfaces.at(0).name, "figure");
        ASSERT_EQ(loaded.notes.size(), 1u);
        EXPECT_NE(loaded.notes[0].find("1 skinned mesh"), std::string::npos);
    }
}

TEST(GltfPose, NormalsTurnWithTheirJoint) {
    GltfBuilder builder = skinned(false);
    const double half = std::sqrt(0.5);
    builder.json["nodes"][1]["rotation"] = {half, 0, 0, half};  // +z to -y; the tip turns along
    for (const glm::vec3& normal : load(builder).scene.normals)
        EXPECT_NEAR(glm::distance(normal, glm::vec3(0, -1, 0)), 0, 1e-5f);
}

// How far the fronts of the triangles agree with their corners' normals: 1 or -1 where all are flat.
std::vector<float> frontsAlongNormals(const Scene& scene) {
    std::vector<float> cosines;
    for (const glm::uvec3& t : scene.triangles) {
        const glm::vec3 a = scene.positions[t.x];
        const glm::vec3 front = glm::cross(scene.positions[t.y] - a, scene.positions[t.z] - a);
        cosines.push_back(glm::dot(glm::normalize(front), scene.normals[t.x]));
    }
    return cosines;
}

// A quad of joint 0 and one of joint 1: as lists without and with indices, and as strips.
GltfBuilder twoQuads(const Json& mode, bool indexed) {
    GltfBuilder builder;
    std::vector<float> positions, normals, weights;
    std::vector<uint8_t> joints;
    std::vector<uint16_t> indices;
    const float corners[4][2] = {{0, 0}, {1, 0}, {0, 1}, {1, 1}};
    for (uint8_t joint = 0; joint < 2; ++joint) {
        std::vector<int> order =
            indexed || mode == 5 ? std::vector<int>{0, 1, 2, 3} : std::vector<int>{0, 1, 2, 2, 1, 3};
        for (const int i : indexed ? std::vector<int>{0, 1, 2, 2, 1, 3} : std::vector<int>())
            indices.push_back(uint16_t(4 * joint + i));
        for (const int i : order) {
            positions.insert(positions.end(), {corners[i][0] + 3.0f * joint, corners[i][1], 0});
            normals.insert(normals.end(), {0, 0, 1});
            weights.insert(weights.end(), {1, 0, 0, 0});
            joints.insert(joints.end(), {joint, 0, 0, 0});
        }
    }
    const size_t count = positions.size() / 3;
    Json primitive = {
        {"attributes",
         {{"POSITION", builder.floats("VEC3", positions)},
          {"NORMAL", builder.floats("VEC3", normals)},
          {"WEIGHTS_0", builder.floats("VEC4", weights)},
          {"JOINTS_0", builder.accessor(builder.view(joints, 4), test::kUnsignedByte, "VEC4", count)}}}};
    if (!mode.is_null()) primitive["mode"] = mode;
    if (indexed)
        primitive["indices"] =
            builder.accessor(builder.view(indices), test::kUnsignedShort, "SCALAR", indices.size());
    const int mesh = builder.mesh(primitive);
    builder.root(Json::object());
    builder.root(Json::object());
    builder.push("skins", {{"joints", {0, 1}}});
    builder.root({{"mesh", mesh}, {"skin", 0}});
    return builder;
}

TEST(GltfPose, TrianglesOfAMirroringJointTurnWithTheirNormals) {
    const std::pair<Json, bool> cases[] = {{Json(), false}, {Json(), true}, {5, false}};
    for (const auto& [mode, indexed] : cases) {
        for (const Json& scale : {Json{-1, 1, 1}, Json{1, 1, -1}, Json{-2, -1, -1}, Json{-1, -1, 1}}) {
            GltfBuilder builder = twoQuads(mode, indexed);
            builder.json["nodes"][1]["scale"] = scale;
            const Scene scene = load(builder).scene;
            const std::vector<float> cosines = frontsAlongNormals(scene);
            int compared = 0;
            for (size_t t = 0; t < scene.triangles.size(); ++t) {
                const glm::uvec3 corners = scene.triangles[t];
                const uint32_t most = std::max({corners.x, corners.y, corners.z}),
                               least = std::min({corners.x, corners.y, corners.z});
                if (mode == 5 && least < 4 && most >= 4) continue;  // the strip from quad to quad
                EXPECT_NEAR(cosines[t], 1, 1e-5f) << scale.dump() << " triangle " << t;
                ++compared;
            }
            EXPECT_EQ(compared, 4);
        }
    }
}

// The whole figure mirrored, by a node above its joints and its mesh, as exporters write it.
TEST(GltfPose, AMirroredFigureHasItsFrontsOutside) {
    GltfBuilder builder = skinned(false);
    builder.json["nodes"][1]["scale"] = {-1, 1, 1};
    const Scene scene = load(builder).scene;
    for (const float cosine : frontsAlongNormals(scene)) EXPECT_GT(cosine, 0);
}

TEST(GltfPose, AMeshOfASkinnedAndAPlainNode) {
    GltfBuilder builder = skinned(false);
    builder.root({{"mesh", 0}, {"translation", {0, 0, 3}}});
    const Scene scene = load(builder).scene;
    expectPositions(scene, {{0, 0, 3}, {1, 0, 3}, {0, 1, 3}, {5, 0, -1}, {6, 0, 9}, {5, 1, 4}});
}

TEST(GltfPose, BrokenSkinsAreRefused) {
    GltfBuilder builder = skinned(false);
    builder.json["skins"][0]["joints"] = {1};
    EXPECT_THROW(load(builder), FileError);
    builder = skinned(false);
    builder.json["skins"][0]["joints"] = {1, 99};
    EXPECT_THROW(load(builder), FileError);
    builder = skinned(false);
    builder.json["meshes"][0]["primitives"][0]["attributes"].erase("WEIGHTS_0");
    EXPECT_THROW(load(builder), FileError);
}

// A triangle with two targets: one along z (quantised to 16 bits), one of the first corner alone (sparse).
GltfBuilder morphed() {
    GltfBuilder builder;
    const int up =
        builder.accessor(builder.view<int16_t>({0, 0, 32767, 0, 0, 0, 32767, 0, 0, 0, 32767, 0}, 8),
                         test::kShort, "VEC3", 3, true);
    const int corner = builder.accessor(-1, test::kFloat, "VEC3", 3);
    builder.json["accessors"][size_t(corner)]["sparse"] = {
        {"count", 1},
        {"indices", {{"bufferView", builder.view<uint16_t>({0})}, {"componentType", 5123}}},
        {"values", {{"bufferView", builder.view<float>({-4, 0, 0})}}}};
    const int tilted = builder.floats("VEC3", {0, 1, -1, 0, 1, -1, 0, 1, -1});
    builder.push("meshes", {{"primitives",
                             Json::array({{{"attributes",
                                            {{"POSITION", builder.floats("VEC3", kTriangle)},
                                             {"NORMAL", builder.floats("VEC3", kUp)}}},
                                           {"targets", Json::array({{{"POSITION", up}, {"NORMAL", tilted}},
                                                                    {{"POSITION", corner}}})}}})},
                            {"weights", {0.5, 0}}});
    builder.root({{"mesh", 0}, {"translation", {0, 0, 100}}});
    return builder;
}

TEST(GltfPose, WeightsOfTheMeshElseOfTheNode) {
    GltfBuilder builder = morphed();
    LoadedScene loaded = load(builder);
    expectPositions(loaded.scene, {{0, 0, 100.5f}, {1, 0, 100.5f}, {0, 1, 100.5f}});
    EXPECT_NEAR(glm::distance(loaded.scene.normals[0], glm::normalize(glm::vec3(0, 0.5f, 0.5f))), 0, 1e-5f);
    builder.json["nodes"][0]["weights"] = {0, 1};
    expectPositions(load(builder).scene, {{-4, 0, 100}, {1, 0, 100}, {0, 1, 100}});
    builder.json["nodes"][0]["weights"] = {1, 0.5};
    expectPositions(load(builder).scene, {{-2, 0, 101}, {1, 0, 101}, {0, 1, 101}});
}

TEST(GltfPose, MorphedBeforeItIsSkinned) {
    GltfBuilder builder = skinned(false);
    const int target = builder.floats("VEC3", {0, 0, 2, 0, 0, 0, 0, 0, 0});
    builder.json["meshes"][0]["primitives"][0]["targets"] = Json::array({{{"POSITION", target}}});
    builder.json["meshes"][0]["weights"] = {1};
    builder.json["nodes"][1]["scale"] = {1, 1, 3};  // of both joints
    // (0, 0, 2), bound at z - 1, scaled by 3; the tip stands at 10 of those threes.
    expectPositions(load(builder).scene, {{5, 0, 3}, {6, 0, 27}, {5, 1, 12}});
}

TEST(GltfPose, TangentsFollowAndKeepTheirSide) {
    GltfBuilder builder = morphed();
    Json& primitive = builder.json["meshes"][0]["primitives"][0];
    primitive["attributes"]["TANGENT"] = builder.floats("VEC4", {1, 0, 0, -1, 1, 0, 0, -1, 1, 0, 0, -1});
    primitive["attributes"]["TEXCOORD_0"] = builder.floats("VEC2", {0, 0, 1, 0, 0, 1});
    primitive["targets"][0]["TANGENT"] = builder.floats("VEC3", {-1, 0, 0, -1, 0, 0, -1, 0, 0});
    primitive["targets"][1]["TANGENT"] = builder.floats("VEC3", {0, 0, 1, 0, 0, 1, 0, 0, 1});
    primitive["material"] = builder.push("materials", {{"normalTexture", {{"index", 0}}}});
    const std::vector<uint8_t> png = {
        // 1x1
        0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d, 0x49, 0x48, 0x44, 0x52, 0x00,
        0x00, 0x00, 0x01, 0x00, 0x00, 0x00, 0x01, 0x08, 0x00, 0x00, 0x00, 0x00, 0x3a, 0x7e, 0x9b, 0x55, 0x00,
        0x00, 0x00, 0x0a, 0x49, 0x44, 0x41, 0x54, 0x78, 0x9c, 0x63, 0xf8, 0x0f, 0x00, 0x01, 0x01, 0x01, 0x00,
        0x1b, 0xb6, 0xee, 0x56, 0x00, 0x00, 0x00, 0x00, 0x49, 0x45, 0x4e, 0x44, 0xae, 0x42, 0x60, 0x82};
    builder.push("images", {{"bufferView", builder.view(png)}});
    builder.push("textures", {{"source", 0}});
    builder.json["nodes"][0]["weights"] = {1, 1};
    for (const glm::vec4& tangent : load(builder).scene.tangents)
        EXPECT_NEAR(glm::distance(tangent, glm::vec4(0, 0, 1, -1)), 0, 1e-5f);
}

TEST(GltfInstances, EachIsASurfaceBelowItsNode) {
    GltfBuilder builder;
    const int mesh = builder.mesh({{"attributes", {{"POSITION", builder.floats("VEC3", kTriangle)}}}});
    const Json attributes = {
        {"TRANSLATION", builder.floats("VEC3", {1, 0, 0, 2, 0, 0})},
        // 16-bit turns: none, and half a turn about z.
        {"ROTATION", builder.accessor(builder.view<int16_t>({0, 0, 0, 32767, 0, 0, 32767, 0}), test::kShort,
                                      "VEC4", 2, true)},
        {"SCALE", builder.floats("VEC3", {1, 1, 1, 2, -3, 1})},
        {"_ID", builder.floats("SCALAR", {7, 8})}};
    builder.root({{"mesh", mesh},
                  {"name", "chairs"},
                  {"translation", {0, 0, 5}},
                  {"extensions", {{"EXT_mesh_gpu_instancing", {{"attributes", attributes}}}}}});
    builder.json["extensionsUsed"] = builder.json["extensionsRequired"] = {"EXT_mesh_gpu_instancing"};
    const LoadedScene loaded = load(builder);
    EXPECT_TRUE(loaded.notes.empty());
    ASSERT_EQ(loaded.scene.surfaces.size(), 2u);
    EXPECT_EQ(loaded.scene.surfaces[1].name, "chairs");
    EXPECT_NE(loaded.scene.surfaces[0].node, loaded.scene.surfaces[1].node);
    expectPositions(loaded.scene, {{1, 0, 5}, {2, 0, 5}, {1, 1, 5}, {2, 0, 5}, {0, 0, 5}, {2, 3, 5}});

    GltfBuilder counted = builder;
    Json& own = counted.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"];
    own = {{"_ID", own["_ID"]}};
    expectPositions(load(counted).scene, {{0, 0, 5}, {1, 0, 5}, {0, 1, 5}, {0, 0, 5}, {1, 0, 5}, {0, 1, 5}});

    builder.json["accessors"][1]["count"] = 1;
    EXPECT_THROW(load(builder), FileError);  // the attributes differ in count
}

TEST(GltfInstances, ClaimedCountsAreChecked) {
    GltfBuilder builder;
    const int mesh = builder.mesh({{"attributes", {{"POSITION", builder.floats("VEC3", kTriangle)}}}});
    const int nowhere = builder.accessor(-1, test::kFloat, "VEC3", size_t(1) << 40);
    builder.root(
        {{"mesh", mesh},
         {"extensions", {{"EXT_mesh_gpu_instancing", {{"attributes", {{"TRANSLATION", nowhere}}}}}}}});
    EXPECT_THROW(load(builder), FileError);
}

TEST(GltfVisibility, HiddenNodesKeepTheirCamerasOnly) {
    GltfBuilder builder;
    const int mesh = builder.mesh({{"attributes", {{"POSITION", builder.floats("VEC3", kTriangle)}}}});
    builder.json["extensions"]["KHR_lights_punctual"]["lights"] = Json::array({{{"type", "point"}}});
    builder.push("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 0.1}}}});
    const Json light = {{"KHR_lights_punctual", {{"light", 0}}}};
    // Below a hidden node, what says that it is visible is not.
    const int below = builder.push(
        "nodes",
        {{"mesh", mesh}, {"camera", 0}, {"extensions", {{"KHR_node_visibility", {{"visible", true}}}}}});
    const int lamp = builder.push("nodes", {{"extensions", light}});
    const int hidden = builder.root({{"children", {below, lamp}},
                                     {"mesh", mesh},
                                     {"extensions", {{"KHR_node_visibility", {{"visible", false}}}}}});
    builder.root({{"mesh", mesh}, {"translation", {0, 0, 1}}, {"extensions", light}});
    LoadedScene loaded = load(builder);
    EXPECT_TRUE(loaded.notes.empty());
    EXPECT_EQ(loaded.scene.surfaces.size(), 1u);
    EXPECT_EQ(loaded.scene.lights.size(), 1u);
    EXPECT_EQ(loaded.scene.cameras.size(), 1u);
    builder.json["nodes"][size_t(hidden)].erase("extensions");
    loaded = load(builder);
    EXPECT_EQ(loaded.scene.surfaces.size(), 3u);
    EXPECT_EQ(loaded.scene.lights.size(), 2u);
}

}  // namespace
}  // namespace phat
