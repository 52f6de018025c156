// Materials of other models, variants, and extensions that are drawn without.

#include <gtest/gtest.h>

#include "io/base/file_error.h"
#include "io/gltf/gltf_built.h"
#include "io/gltf/gltf_variants.h"
#include "support/temporary_folder.h"

namespace phat {
namespace {

using test::GltfBuilder;
using test::kPng16;
using test::load;
using Json = nlohmann::json;

std::string reasonOf(const GltfBuilder& builder, const std::string& variant = {}) {
    try {
        load(builder, variant);
    } catch (const FileError& error) {
        return error.reason;
    }
    return "loaded";
}

// A triangle with the material.
GltfBuilder triangleOf(const Json& material) {
    GltfBuilder builder;
    builder.push("materials", material);
    builder.root({{"mesh", builder.mesh({{"attributes",
                                          {{"POSITION", builder.floats("VEC3", {0, 0, 0, 1, 0, 0, 0, 1, 0})},
                                           {"TEXCOORD_0", builder.floats("VEC2", {0, 0, 1, 0, 0, 1})}}},
                                         {"material", 0}})}});
    return builder;
}

Json specularGlossiness(const Json& values) {
    return {
        {"pbrMetallicRoughness", {{"baseColorFactor", {0, 0, 0, 1}}}},  // the fallback, which does not count
        {"emissiveFactor", {0, 0.5, 0}},
        {"extensions", {{"KHR_materials_pbrSpecularGlossiness", values}}}};
}

TEST(GltfSpecularGlossiness, FactorsKeepTheirReflectance) {
    GltfBuilder builder = triangleOf(specularGlossiness({{"diffuseFactor", {0.1, 0.2, 0.3, 0.4}},
                                                         {"specularFactor", {0.5, 0.6, 0.7}},
                                                         {"glossinessFactor", 0.75}}));
    builder.json["extensionsUsed"] =
        builder.json["extensionsRequired"] = {"KHR_materials_pbrSpecularGlossiness"};
    const LoadedScene loaded = load(builder);
    EXPECT_TRUE(loaded.notes.empty());
    const Material& material = loaded.scene.materials[0];
    EXPECT_EQ(material.baseColor, glm::vec4(0.1f, 0.2f, 0.3f, 0.4f));
    EXPECT_EQ(material.metallic, 0);
    EXPECT_EQ(material.roughness, 0.25f);
    EXPECT_EQ(material.specularColor, glm::vec3(0.5f, 0.6f, 0.7f));
    EXPECT_EQ(material.specular, 1);
    EXPECT_EQ(material.ior, 0);  // F0 is the specular colour
    EXPECT_EQ(material.emission, glm::vec3(0, 0.5f, 0));
    // The extension's defaults: white, and a mirror.
    const Material bare = load(triangleOf(specularGlossiness(Json::object()))).scene.materials[0];
    EXPECT_EQ(bare.baseColor, glm::vec4(1));
    EXPECT_EQ(bare.specularColor, glm::vec3(1));
    EXPECT_EQ(bare.roughness, 0);
}

TEST(GltfSpecularGlossiness, TexturesAreConverted) {
    GltfBuilder builder = triangleOf(specularGlossiness(
        {{"diffuseTexture", {{"index", 1}}},
         {"specularGlossinessTexture",
          {{"index", 0}, {"extensions", {{"KHR_texture_transform", {{"scale", {2, 2}}}}}}}},
         {"glossinessFactor", 0.5}}));
    builder.push("images", {{"bufferView", builder.view(kPng16)}});
    builder.push("images", {{"bufferView", builder.view(kPng16)}});
    builder.push("samplers", {{"wrapS", 33071}});
    builder.push("textures", {{"source", 0}, {"sampler", 0}});
    builder.push("textures", {{"source", 1}});
    const Scene scene = load(builder).scene;
    const Material& material = scene.materials[0];
    EXPECT_EQ(scene.images[size_t(material.baseColorTexture.image)]->texels[0],
              glm::u8vec4(255, 128, 0, 255));
    const TextureImage& specular = *scene.images[size_t(material.specularColorTexture.image)];
    EXPECT_EQ(specular.texels[1], glm::u8vec4(18, 0, 255, 64));
    const TextureSlot& slot = material.metallicRoughnessTexture;
    const TextureImage& roughness = *scene.images[size_t(slot.image)];
    ASSERT_EQ(roughness.texels.size(), 2u);
    EXPECT_EQ(roughness.texels[0].g, 128);  // 255 * (1 - .5)
    EXPECT_EQ(roughness.texels[1].g, 223);  // 255 - .5 * 64
    EXPECT_EQ(roughness.texels[1].b, 0);
    EXPECT_EQ(material.roughness, 1);
    EXPECT_EQ(material.metallic, 0);
    EXPECT_EQ(slot.wrapU, Wrap::clampToEdge);
    EXPECT_EQ(slot.uvTransform[0], glm::vec2(2, 0));
}

GltfBuilder withVariants() {
    GltfBuilder builder = triangleOf({{"name", "oak"}});
    builder.push("materials", {{"name", "walnut"}});
    builder.push("materials", {{"name", "pine"}});
    builder.json["extensionsUsed"] = {"KHR_materials_variants"};
    builder.json["extensions"]["KHR_materials_variants"]["variants"] =
        Json::array({{{"name", "dark"}}, {{"name", "light"}}, {{"name", "bright"}}, {{"name", "as is"}}});
    builder.json["meshes"][0]["primitives"][0]["extensions"]["KHR_materials_variants"]["mappings"] =
        Json::array({{{"material", 1}, {"variants", {0}}}, {{"material", 2}, {"variants", {1, 2}}}});
    return builder;
}

TEST(GltfVariants, GiveSurfacesTheirMaterials) {
    const auto materialIn = [](const std::string& variant) {
        const LoadedScene loaded = load(withVariants(), variant);
        EXPECT_TRUE(loaded.notes.empty());
        return loaded.scene.materials.at(loaded.scene.surfaces.at(0).material).name;
    };
    EXPECT_EQ(materialIn(""), "oak");
    EXPECT_EQ(materialIn("dark"), "walnut");
    EXPECT_EQ(materialIn("light"), "pine");
    EXPECT_EQ(materialIn("bright"), "pine");
    EXPECT_EQ(materialIn("as is"), "oak");
}

TEST(GltfVariants, AreListedAndNamesMustExist) {
    const TemporaryFolder folder;
    writeBytes(folder.file("a.glb"), withVariants().glb());
    EXPECT_EQ(gltfVariants(openGltf(folder.file("a.glb"))),
              (std::vector<std::string>{"dark", "light", "bright", "as is"}));
    EXPECT_NE(reasonOf(withVariants(), "red").find("dark, light, bright, as is"), std::string::npos);
    EXPECT_NE(reasonOf(triangleOf(Json::object()), "red").find("no material variants"), std::string::npos);
}

TEST(GltfLooks, WhatIsDrawnWithoutIsNotedOnce) {
    for (const char* name :
         {"KHR_materials_sheen", "KHR_materials_anisotropy", "KHR_materials_iridescence",
          "KHR_materials_dispersion", "KHR_materials_volume_scatter", "KHR_materials_diffuse_transmission"}) {
        GltfBuilder builder = triangleOf({{"extensions", {{name, Json::object()}}}});
        builder.push("materials", {{"extensions", {{name, Json::object()}}}});
        builder.json["extensionsUsed"] = builder.json["extensionsRequired"] = {name};
        const LoadedScene loaded = load(builder);
        EXPECT_EQ(loaded.scene.triangles.size(), 1u);
        ASSERT_EQ(loaded.notes.size(), 1u) << name;
        EXPECT_NE(loaded.notes[0].find(name), std::string::npos);
    }
    GltfBuilder builder = triangleOf(Json::object());
    builder.json["extensionsRequired"] = {"ACME_other_geometry"};
    EXPECT_NE(reasonOf(builder).find("ACME_other_geometry"), std::string::npos);
}

TEST(GltfLooks, Ktx2TexturesNeedAFallback) {
    GltfBuilder builder = triangleOf({{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}});
    builder.push("images", {{"bufferView", builder.view(kPng16)}});
    builder.push("images",
                 {{"bufferView", builder.view<uint8_t>({0xab, 'K', 'T', 'X', ' ', '2', '0', 0xbb})}});
    builder.push(
        "textures",
        {{"source", 0}, {"name", "parquet"}, {"extensions", {{"KHR_texture_basisu", {{"source", 1}}}}}});
    builder.json["extensionsUsed"] = {"KHR_texture_basisu"};
    const LoadedScene loaded = load(builder);
    EXPECT_EQ(loaded.scene.images.size(), 1u);
    ASSERT_EQ(loaded.notes.size(), 1u);
    EXPECT_NE(loaded.notes[0].find("KTX2"), std::string::npos);

    builder.json["extensionsRequired"] = {"KHR_texture_basisu"};
    builder.json["textures"][0].erase("source");
    const std::string reason = reasonOf(builder);
    EXPECT_NE(reason.find("parquet"), std::string::npos) << reason;
    EXPECT_NE(reason.find("ktxdecompress"), std::string::npos) << reason;
    // Nothing uses the material: no reason to refuse the room.
    builder.json["meshes"][0]["primitives"][0]["material"] = builder.push("materials", Json::object());
    EXPECT_EQ(load(builder).scene.triangles.size(), 1u);
}

}  // namespace
}  // namespace phat
