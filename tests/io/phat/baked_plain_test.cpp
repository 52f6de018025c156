// Baked files of scenes that came compressed, instanced or posed: plain glTF that shows the same.

#include <gtest/gtest.h>

#include <algorithm>

#include "io/gltf/gltf_source.h"
#include "io/phat/baked_scene.h"

namespace phat {
namespace {

using nlohmann::json;

void expectSamePlaces(const Scene& a, const Scene& b, const std::string& name) {
    ASSERT_EQ(a.triangles.size(), b.triangles.size()) << name;
    for (size_t t = 0; t < a.triangles.size(); ++t)
        for (int corner = 0; corner < 3; ++corner) {
            const uint32_t i = a.triangles[t][corner], j = b.triangles[t][corner];
            ASSERT_EQ(a.positions[i], b.positions[j]) << name << " " << t;
            ASSERT_EQ(a.normals[i], b.normals[j]) << name << " " << t;
            ASSERT_EQ(a.uv0[i], b.uv0[j]) << name << " " << t;
        }
    ASSERT_EQ(a.surfaces.size(), b.surfaces.size());
    for (size_t s = 0; s < a.surfaces.size(); ++s) {
        EXPECT_EQ(a.surfaces[s].node, b.surfaces[s].node) << name;
        EXPECT_EQ(a.materials[a.surfaces[s].material].name, b.materials[b.surfaces[s].material].name) << name;
    }
    ASSERT_EQ(a.images.size(), b.images.size());
    for (size_t i = 0; i < a.images.size(); ++i) EXPECT_EQ(a.images[i]->texels, b.images[i]->texels) << name;
}

// Bakes and reads again; returns the baked file's JSON.
json bakedJson(const std::string& path, const std::string& name, const std::string& variant = {}) {
    const TemporaryFolder folder;
    const std::string target = folder.file("a.phat.glb");
    GltfSource source = openGltf(path);
    const LoadedScene loaded = loadGltf(source, {variant});
    EXPECT_FALSE(loaded.scene.triangles.empty());
    writeBakedFile(target, source, loaded.scene, test::randomBake(loaded.scene, 1, false, 5),
                   test::someRecord());
    expectSamePlaces(loaded.scene, readBakedFile(target).loaded.scene, name);
    return openGltf(target).json;
}

bool uses(const json& gltf, const char* extension) {
    const json used = gltf.value("extensionsUsed", json::array());
    return std::find(used.begin(), used.end(), extension) != used.end() ||
           gltf.dump().find(extension) != std::string::npos;
}

TEST(BakedPlain, CompressedScenes) {
    for (const char* name : {"plain", "draco", "draco-sequential", "meshopt", "meshopt-filters", "quantize",
                             "instance", "webp", "avif"}) {
        const json gltf =
            bakedJson(PHAT_SOURCE_DIR "/tests/data/encoded/" + std::string(name) + ".glb", name);
        for (const char* gone :
             {"KHR_draco_mesh_compression", "EXT_meshopt_compression", "EXT_mesh_gpu_instancing"})
            EXPECT_FALSE(uses(gltf, gone)) << name << " " << gone;
        EXPECT_EQ(uses(gltf, "EXT_texture_webp"), std::string(name) == "webp");
        EXPECT_EQ(uses(gltf, "EXT_texture_avif"), std::string(name) == "avif");
        EXPECT_EQ(gltf.at("images").at(0).at("mimeType"), std::string(name) == "webp"   ? "image/webp"
                                                          : std::string(name) == "avif" ? "image/avif"
                                                                                        : "image/png");
    }
}

// A skinned and morphed triangle with an animation of both; a plain node shows the same mesh.
TEST(BakedPlain, PosedMeshes) {
    test::GltfBuilder builder;
    const int target = builder.floats("VEC3", {0, 0, 2, 0, 0, 0, 0, 0, 0});
    const int mesh =
        builder.mesh({{"attributes",
                       {{"POSITION", builder.floats("VEC3", {0, 0, 0, 1, 0, 0, 0, 1, 0})},
                        {"NORMAL", builder.floats("VEC3", {0, 0, 1, 0, 0, 1, 0, 0, 1})},
                        {"JOINTS_0", builder.accessor(builder.view(std::vector<uint8_t>(12, 0), 4),
                                                      test::kUnsignedByte, "VEC4", 3)},
                        {"WEIGHTS_0", builder.floats("VEC4", {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0})}}},
                      {"targets", json::array({{{"POSITION", target}}})}});
    builder.json["meshes"][0]["weights"] = {1};
    const int joint = builder.root({{"translation", {0, 0, 4}}});
    const int node = builder.root({{"mesh", mesh}, {"skin", 0}, {"translation", {50, 0, 0}}});
    builder.root({{"mesh", mesh}, {"translation", {5, 0, 0}}});
    builder.push("skins", {{"joints", {joint}}});
    const int times = builder.floats("SCALAR", {0, 1}), weights = builder.floats("SCALAR", {0, 1});
    const int moves = builder.floats("VEC3", {0, 0, 4, 0, 0, 5});
    builder.push("animations",
                 {{"samplers", json::array({{{"input", times}, {"output", weights}},
                                            {{"input", times}, {"output", moves}}})},
                  {"channels",
                   json::array({{{"sampler", 0}, {"target", {{"node", node}, {"path", "weights"}}}},
                                {{"sampler", 1}, {"target", {{"node", joint}, {"path", "translation"}}}}})}});
    const TemporaryFolder folder;
    writeBytes(folder.file("a.glb"), builder.glb());
    const json gltf = bakedJson(folder.file("a.glb"), "posed");
    EXPECT_FALSE(gltf.contains("skins"));
    for (const json& written : gltf["nodes"]) {
        EXPECT_FALSE(written.contains("skin"));
        EXPECT_FALSE(written.contains("weights"));
    }
    for (const json& written : gltf["meshes"]) {
        EXPECT_FALSE(written.contains("weights"));
        EXPECT_FALSE(written["primitives"][0].contains("targets"));
        EXPECT_FALSE(written["primitives"][0]["attributes"].contains("JOINTS_0"));
    }
    ASSERT_EQ(gltf["animations"].size(), 1u);
    EXPECT_EQ(gltf["animations"][0]["channels"].size(), 1u);  // the joint still moves; no surface follows
}

TEST(BakedPlain, VariantsStayAndTheChosenOneIsShown) {
    test::GltfBuilder builder;
    builder.push("materials", {{"name", "oak"}});
    builder.push("materials", {{"name", "walnut"}});
    builder.json["extensionsUsed"] = {"KHR_materials_variants"};
    builder.json["extensions"]["KHR_materials_variants"]["variants"] = json::array({{{"name", "dark"}}});
    builder.root(
        {{"mesh",
          builder.mesh({{"attributes", {{"POSITION", builder.floats("VEC3", {0, 0, 0, 1, 0, 0, 0, 1, 0})}}},
                        {"material", 0},
                        {"extensions",
                         {{"KHR_materials_variants",
                           {{"mappings", json::array({{{"material", 1}, {"variants", {0}}}})}}}}}})}});
    const TemporaryFolder folder;
    writeBytes(folder.file("a.glb"), builder.glb());
    for (const std::string variant : {"", "dark"}) {
        const json gltf = bakedJson(folder.file("a.glb"), "variants", variant);
        EXPECT_TRUE(uses(gltf, "KHR_materials_variants"));
        EXPECT_EQ(gltf["meshes"][0]["primitives"][0]["material"], variant.empty() ? 0 : 1);
    }
}

TEST(BakedPlain, SpecularGlossinessBecomesMetallicRoughness) {
    test::GltfBuilder builder;
    builder.push(
        "materials",
        {{"extensions", {{"KHR_materials_pbrSpecularGlossiness", {{"specularFactor", {0.5, 0.5, 0.5}}}}}}});
    builder.json["extensionsUsed"] = {"KHR_materials_pbrSpecularGlossiness"};
    builder.root(
        {{"mesh",
          builder.mesh({{"attributes", {{"POSITION", builder.floats("VEC3", {0, 0, 0, 1, 0, 0, 0, 1, 0})}}},
                        {"material", 0}})}});
    const TemporaryFolder folder;
    writeBytes(folder.file("a.glb"), builder.glb());
    const json gltf = bakedJson(folder.file("a.glb"), "specular");
    EXPECT_FALSE(uses(gltf, "KHR_materials_pbrSpecularGlossiness"));
    EXPECT_TRUE(uses(gltf, "KHR_materials_specular"));
    EXPECT_TRUE(uses(gltf, "KHR_materials_ior"));
}

}  // namespace
}  // namespace phat
