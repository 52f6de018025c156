#include <gtest/gtest.h>
#include <zlib.h>

#include <cmath>

#include "io/base/file_error.h"
#include "io/gltf/gltf_built.h"

namespace phat {
namespace {

using test::GltfBuilder;
using test::kPng16;
using test::load;
using Json = nlohmann::json;

// 2x2 texels, RGB 8 bit: red, green / blue, white.
const std::vector<uint8_t> kPng8 = {
    0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d, 0x49, 0x48, 0x44,
    0x52, 0x00, 0x00, 0x00, 0x02, 0x00, 0x00, 0x00, 0x02, 0x08, 0x02, 0x00, 0x00, 0x00, 0xfd,
    0xd4, 0x9a, 0x73, 0x00, 0x00, 0x00, 0x12, 0x49, 0x44, 0x41, 0x54, 0x78, 0x9c, 0x63, 0xf8,
    0xcf, 0xc0, 0xc0, 0x00, 0xc2, 0x0c, 0xff, 0x81, 0x00, 0x00, 0x1f, 0xee, 0x05, 0xfb, 0x0b,
    0xd9, 0x68, 0x8b, 0x00, 0x00, 0x00, 0x00, 0x49, 0x45, 0x4e, 0x44, 0xae, 0x42, 0x60, 0x82,
};

Material materialOf(const Json& material) {
    GltfBuilder builder;
    builder.push("materials", material);
    return load(builder).scene.materials.at(0);
}

// A material with one texture, under construction.
struct Textured {
    GltfBuilder builder;

    explicit Textured(const std::vector<uint8_t>& picture = kPng8) {
        builder.push("images", {{"bufferView", builder.view(picture)}, {"mimeType", "image/png"}});
        builder.push("textures", {{"source", 0}});
    }
};

TEST(GltfMaterials, DefaultsAreTheSpecifications) {
    const Material material = materialOf(Json::object());
    EXPECT_EQ(material.baseColor, glm::vec4(1));
    EXPECT_EQ(material.metallic, 1);
    EXPECT_EQ(material.roughness, 1);
    EXPECT_EQ(material.emission, glm::vec3(0));
    EXPECT_EQ(material.specular, 1);
    EXPECT_EQ(material.specularColor, glm::vec3(1));
    EXPECT_EQ(material.ior, 1.5f);
    EXPECT_EQ(material.clearcoat, 0);
    EXPECT_EQ(material.alphaMode, AlphaMode::opaque);
    EXPECT_EQ(material.alphaCutoff, 0.5f);
    EXPECT_FALSE(material.doubleSided);
    EXPECT_FALSE(material.unlit);
    EXPECT_EQ(material.baseColorTexture.image, -1);
}

TEST(GltfMaterials, FactorsAndExtensions) {
    const Material material = materialOf(
        {{"name", "car paint"},
         {"pbrMetallicRoughness",
          {{"baseColorFactor", {0.1, 0.2, 0.3, 0.4}}, {"metallicFactor", 0.5}, {"roughnessFactor", 0.25}}},
         {"emissiveFactor", {0.5, 0.25, 1}},
         {"doubleSided", true},
         {"alphaMode", "MASK"},
         {"alphaCutoff", 0.75},
         {"extensions",
          {{"KHR_materials_emissive_strength", {{"emissiveStrength", 8}}},
           {"KHR_materials_ior", {{"ior", 1.33}}},
           {"KHR_materials_specular", {{"specularFactor", 0.6}, {"specularColorFactor", {0.2, 1, 2}}}},
           {"KHR_materials_clearcoat", {{"clearcoatFactor", 0.9}, {"clearcoatRoughnessFactor", 0.1}}}}}});
    EXPECT_EQ(material.name, "car paint");
    EXPECT_EQ(material.baseColor, glm::vec4(0.1f, 0.2f, 0.3f, 0.4f));
    EXPECT_EQ(material.metallic, 0.5f);
    EXPECT_EQ(material.roughness, 0.25f);
    EXPECT_EQ(material.emission, glm::vec3(4, 2, 8));
    EXPECT_TRUE(material.doubleSided);
    EXPECT_EQ(material.alphaMode, AlphaMode::mask);
    EXPECT_EQ(material.alphaCutoff, 0.75f);
    EXPECT_EQ(material.ior, 1.33f);
    EXPECT_EQ(material.specular, 0.6f);
    EXPECT_EQ(material.specularColor, glm::vec3(0.2f, 1, 2));
    EXPECT_EQ(material.clearcoat, 0.9f);
    EXPECT_EQ(material.clearcoatRoughness, 0.1f);
    EXPECT_EQ(materialOf({{"alphaMode", "BLEND"}}).alphaMode, AlphaMode::blend);
    EXPECT_EQ(materialOf({{"extensions", {{"KHR_materials_ior", {{"ior", 0}}}}}}).ior, 0);
}

TEST(GltfMaterials, TransmissionAndVolume) {
    const Material thin =
        materialOf({{"extensions", {{"KHR_materials_transmission", {{"transmissionFactor", 0.9}}}}}});
    EXPECT_EQ(thin.transmission, 0.9f);
    EXPECT_EQ(thin.thickness, 0);
    EXPECT_EQ(thin.attenuationColor, glm::vec3(1));
    EXPECT_TRUE(std::isinf(thin.attenuationDistance));
    EXPECT_EQ(materialOf({{"extensions", {{"KHR_materials_transmission", Json::object()}}}}).transmission, 0);
    const Material solid = materialOf({{"extensions",
                                        {{"KHR_materials_transmission", {{"transmissionFactor", 1}}},
                                         {"KHR_materials_volume",
                                          {{"thicknessFactor", 0.02},
                                           {"attenuationDistance", 0.5},
                                           {"attenuationColor", {0.1, 0.9, 0.2}}}}}}});
    EXPECT_EQ(solid.thickness, 0.02f);
    EXPECT_EQ(solid.attenuationDistance, 0.5f);
    EXPECT_EQ(solid.attenuationColor, glm::vec3(0.1f, 0.9f, 0.2f));
    // What no light can be: clamped.
    const Material wrong = materialOf(
        {{"extensions",
          {{"KHR_materials_transmission", {{"transmissionFactor", 2}}},
           {"KHR_materials_volume",
            {{"thicknessFactor", -1}, {"attenuationDistance", 0}, {"attenuationColor", {2, -1, 1}}}}}}});
    EXPECT_EQ(wrong.transmission, 1);
    EXPECT_EQ(wrong.thickness, 0);
    EXPECT_GT(wrong.attenuationDistance, 0);
    EXPECT_EQ(wrong.attenuationColor, glm::vec3(1, 0, 1));
}

// Thickness is measured in the mesh, along its normals (KHR_materials_volume).
TEST(GltfMaterials, NodesScaleThickness) {
    const auto metersPerUnit = [](const Json& node) {
        GltfBuilder builder;
        // In the plane z = 0.
        const int mesh = builder.mesh(
            {{"attributes", {{"POSITION", builder.floats("VEC3", {0, 0, 0, 1, 0, 0, 0, 1, 0})}}}});
        Json placed = node;
        placed["mesh"] = mesh;
        builder.root(placed);
        return load(builder).scene.surfaces.at(0).metersPerUnit;
    };
    EXPECT_EQ(metersPerUnit(Json::object()), 1);
    EXPECT_FLOAT_EQ(metersPerUnit({{"scale", {3, 3, 3}}}), 3);
    EXPECT_FLOAT_EQ(metersPerUnit({{"scale", {3, 5, 0.25}}}), 0.25f);
    EXPECT_FLOAT_EQ(metersPerUnit({{"scale", {-2, -2, -2}}, {"rotation", {0.6, 0, 0, 0.8}}}), 2);
    EXPECT_EQ(metersPerUnit({{"scale", {1, 1, 0}}}), 0);
    // Sheared: x += z. Planes of the same z stay as far apart as they were.
    EXPECT_FLOAT_EQ(metersPerUnit({{"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1}}}), 1);
}

TEST(GltfMaterials, TransmissionAndThicknessHaveTextures) {
    Textured textured;
    textured.builder.push(
        "materials",
        {{"extensions",
          {{"KHR_materials_transmission",
            {{"transmissionFactor", 1}, {"transmissionTexture", {{"index", 0}}}}},
           {"KHR_materials_volume", {{"thicknessFactor", 1}, {"thicknessTexture", {{"index", 0}}}}}}}});
    const Scene scene = load(textured.builder).scene;
    ASSERT_EQ(scene.images.size(), 1u);  // one that only glass reads
    const Material& material = scene.materials[0];
    EXPECT_EQ(material.transmissionTexture.image, 0);
    EXPECT_EQ(material.thicknessTexture.image, 0);
}

TEST(GltfMaterials, FactorsOutsideTheirRangeAreClampedAndCounted) {
    GltfBuilder builder;
    builder.push("materials", {{"pbrMetallicRoughness", {{"roughnessFactor", 7}, {"metallicFactor", -1}}},
                               {"extensions", {{"KHR_materials_ior", {{"ior", 0.5}}}}}});
    const LoadedScene loaded = load(builder);
    EXPECT_EQ(loaded.scene.materials[0].roughness, 1);
    EXPECT_EQ(loaded.scene.materials[0].metallic, 0);
    EXPECT_EQ(loaded.scene.materials[0].ior, 1);
    ASSERT_EQ(loaded.notes.size(), 1u);
    EXPECT_EQ(loaded.notes[0].substr(0, 18), "3 material factors");
}

TEST(GltfMaterials, UnlitShowsItsBaseColour) {
    Textured textured;
    textured.builder.push("materials",
                          {{"pbrMetallicRoughness",
                            {{"baseColorFactor", {0.2, 0.4, 0.6, 1}}, {"baseColorTexture", {{"index", 0}}}}},
                           {"emissiveFactor", {1, 1, 1}},
                           {"extensions", {{"KHR_materials_unlit", Json::object()}}}});
    const Scene scene = load(textured.builder).scene;
    const Material& material = scene.materials[0];
    EXPECT_TRUE(material.unlit);
    EXPECT_EQ(material.emission, glm::vec3(0.2f, 0.4f, 0.6f));
    EXPECT_EQ(material.emissionTexture.image, 0);
    EXPECT_EQ(material.baseColorTexture.image, 0);
    EXPECT_EQ(scene.images.size(), 1u);
}

TEST(GltfMaterials, EveryTextureSlotIsReadWithItsOwnSettings) {
    Textured textured;
    const auto use = [](int texCoord) { return Json{{"index", 0}, {"texCoord", texCoord}}; };
    Json normal = use(1), coatNormal = use(0);
    normal["scale"] = 0.5;
    coatNormal["scale"] = 2;
    textured.builder.push(
        "materials",
        {{"pbrMetallicRoughness", {{"baseColorTexture", use(1)}, {"metallicRoughnessTexture", use(0)}}},
         {"normalTexture", normal},
         {"emissiveTexture", use(1)},
         {"emissiveFactor", {1, 1, 1}},
         {"extensions",
          {{"KHR_materials_specular", {{"specularTexture", use(1)}, {"specularColorTexture", use(0)}}},
           {"KHR_materials_clearcoat",
            {{"clearcoatFactor", 1},
             {"clearcoatTexture", use(1)},
             {"clearcoatRoughnessTexture", use(0)},
             {"clearcoatNormalTexture", coatNormal}}}}}});
    const Scene scene = load(textured.builder).scene;
    const Material& m = scene.materials[0];
    EXPECT_EQ(m.normalScale, 0.5f);
    EXPECT_EQ(m.clearcoatNormalScale, 2);
    const TextureSlot* slots[] = {
        &m.baseColorTexture, &m.metallicRoughnessTexture,  &m.normalTexture,
        &m.emissionTexture,  &m.specularTexture,           &m.specularColorTexture,
        &m.clearcoatTexture, &m.clearcoatRoughnessTexture, &m.clearcoatNormalTexture};
    const int uvSets[] = {1, 0, 1, 1, 1, 0, 1, 0, 0};
    for (int i = 0; i < 9; ++i) {
        EXPECT_EQ(slots[i]->image, 0) << i;
        EXPECT_EQ(slots[i]->uvSet, uvSets[i]) << i;
    }
    EXPECT_EQ(scene.images.size(), 1u);  // decoded once
}

TEST(GltfMaterials, PicturesThatAreNamedTwiceAreDecodedOnce) {
    GltfBuilder builder;
    const int view = builder.view(kPng8), other = builder.view(kPng8);
    builder.json["bufferViews"].push_back(builder.json["bufferViews"][size_t(view)]);  // the same bytes
    const int sameBytes = int(builder.json["bufferViews"].size()) - 1;
    for (const int shown : {view, view, sameBytes, other}) {
        builder.push("images", {{"bufferView", shown}, {"mimeType", "image/png"}});
        const int image = int(builder.json["images"].size()) - 1;
        builder.push("textures", {{"source", image}});
        builder.push("materials", {{"emissiveTexture", {{"index", image}}}, {"emissiveFactor", {1, 1, 1}}});
    }
    const Scene scene = load(builder).scene;
    EXPECT_EQ(scene.images.size(), 2u);
    for (int i = 0; i < 4; ++i)
        EXPECT_EQ(scene.materials[size_t(i)].emissionTexture.image, i == 3 ? 1 : 0) << i;
}

TEST(GltfMaterials, TextureTransformOffsetsRotatesScales) {
    Textured textured;
    textured.builder.push("materials", {{"pbrMetallicRoughness",
                                         {{"baseColorTexture",
                                           {{"index", 0},
                                            {"texCoord", 0},
                                            {"extensions",
                                             {{"KHR_texture_transform",
                                               {{"offset", {0.25, 0.5}},
                                                {"rotation", std::acos(-1.0) / 2},
                                                {"scale", {2, 3}},
                                                {"texCoord", 1}}}}}}}}}});
    const TextureSlot slot = load(textured.builder).scene.materials[0].baseColorTexture;
    EXPECT_EQ(slot.uvSet, 1);
    // A quarter turn counter-clockwise, seen with v pointing down, takes +u to -v and +v to +u.
    const auto at = [&](float u, float v) { return slot.uvTransform * glm::vec3(u, v, 1); };
    EXPECT_NEAR(glm::distance(at(0, 0), glm::vec2(0.25f, 0.5f)), 0, 1e-6f);
    EXPECT_NEAR(glm::distance(at(1, 0), glm::vec2(0.25f, -1.5f)), 0, 1e-6f);
    EXPECT_NEAR(glm::distance(at(0, 1), glm::vec2(3.25f, 0.5f)), 0, 1e-6f);
}

TEST(GltfMaterials, SamplersWrapAndFilter) {
    Textured textured;
    textured.builder.push("samplers", {{"wrapS", 33071}, {"wrapT", 33648}, {"magFilter", 9728}});
    textured.builder.push("textures", {{"source", 0}, {"sampler", 0}});
    textured.builder.push(
        "materials",
        {{"pbrMetallicRoughness",
          {{"baseColorTexture", {{"index", 1}}}, {"metallicRoughnessTexture", {{"index", 0}}}}}});
    const Material material = load(textured.builder).scene.materials[0];
    EXPECT_EQ(material.baseColorTexture.wrapU, Wrap::clampToEdge);
    EXPECT_EQ(material.baseColorTexture.wrapV, Wrap::mirroredRepeat);
    EXPECT_TRUE(material.baseColorTexture.nearest);
    EXPECT_EQ(material.metallicRoughnessTexture.wrapU, Wrap::repeat);
    EXPECT_FALSE(material.metallicRoughnessTexture.nearest);
}

// A mirrored node mirrors the relief too: the frame's second and third axes follow the geometry.
TEST(GltfMaterials, TangentFramesFollowMirroredNodes) {
    for (const bool given : {true, false}) {
        Textured textured;
        GltfBuilder& builder = textured.builder;
        builder.push("materials", {{"normalTexture", {{"index", 0}}}});
        Json attributes = {{"POSITION", builder.floats("VEC3", {0, 0, 0, 1, 0, 0, 0, 1, 0})},
                           {"NORMAL", builder.floats("VEC3", {0, 0, 1, 0, 0, 1, 0, 0, 1})},
                           {"TEXCOORD_0", builder.floats("VEC2", {0, 1, 1, 1, 0, 0})}};
        if (given) attributes["TANGENT"] = builder.floats("VEC4", {1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1});
        const int mesh = builder.mesh({{"attributes", attributes}, {"material", 0}});
        builder.root({{"mesh", mesh}});
        builder.root({{"mesh", mesh}, {"scale", {-2, 1, 1}}});
        builder.root({{"mesh", mesh}, {"scale", {1, -3, 1}}});
        const Scene scene = load(builder).scene;
        ASSERT_EQ(scene.tangents.size(), 9u);
        const auto bitangent = [&](size_t v) {
            return scene.tangents[v].w * glm::cross(scene.normals[v], glm::vec3(scene.tangents[v]));
        };
        EXPECT_EQ(glm::vec3(scene.tangents[0]), glm::vec3(1, 0, 0)) << given;
        EXPECT_EQ(bitangent(0), glm::vec3(0, 1, 0)) << given;
        EXPECT_EQ(glm::vec3(scene.tangents[3]), glm::vec3(-1, 0, 0)) << given;
        EXPECT_EQ(bitangent(3), glm::vec3(0, 1, 0)) << given;
        EXPECT_EQ(glm::vec3(scene.tangents[6]), glm::vec3(1, 0, 0)) << given;
        EXPECT_EQ(bitangent(6), glm::vec3(0, -1, 0)) << given;
    }
}

TEST(GltfMaterials, PicturesAreDecodedToEightBitRgba) {
    const auto imageOf = [](const std::vector<uint8_t>& picture) {
        Textured textured(picture);
        textured.builder.push("materials",
                              {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}});
        return load(textured.builder).scene.images.at(0);
    };
    const TextureImage small = imageOf(kPng8);
    ASSERT_EQ(small.width, 2);
    ASSERT_EQ(small.height, 2);
    EXPECT_EQ(small.texels[0], glm::u8vec4(255, 0, 0, 255));
    EXPECT_EQ(small.texels[1], glm::u8vec4(0, 255, 0, 255));
    EXPECT_EQ(small.texels[2], glm::u8vec4(0, 0, 255, 255));
    EXPECT_EQ(small.texels[3], glm::u8vec4(255));
    const TextureImage deep = imageOf(kPng16);
    ASSERT_EQ(deep.width, 2);
    ASSERT_EQ(deep.height, 1);
    EXPECT_EQ(deep.texels[0], glm::u8vec4(255, 128, 0, 255));
    EXPECT_EQ(deep.texels[1], glm::u8vec4(0x12, 0, 255, 64));
}

TEST(GltfMaterials, PicturesThatCannotBeHadAreNotedAndLeftWhite) {
    std::vector<uint8_t> large = kPng8;
    large[16] = large[20] = 0x7f;  // IHDR width and height
    for (const std::vector<uint8_t>& picture :
         {std::vector<uint8_t>(kPng8.begin(), kPng8.begin() + 50), std::vector<uint8_t>{1, 2, 3, 4}, large}) {
        Textured textured(picture);
        textured.builder.push("materials", {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}},
                                            {"normalTexture", {{"index", 0}}}});
        const LoadedScene loaded = load(textured.builder);
        EXPECT_EQ(loaded.scene.materials[0].baseColorTexture.image, -1);
        EXPECT_TRUE(loaded.scene.images.empty());
        ASSERT_EQ(loaded.notes.size(), 1u);
        EXPECT_EQ(loaded.notes[0].substr(0, 7), "image 0");
    }
}

// The head of a PNG, then `inflatedBytes` zeros as its data.
std::vector<uint8_t> pngBomb(const std::vector<uint8_t>& png, size_t inflatedBytes) {
    const std::vector<uint8_t> zeros(inflatedBytes);
    uLongf packedSize = compressBound(inflatedBytes);
    std::vector<uint8_t> packed(packedSize);
    compress2(packed.data(), &packedSize, zeros.data(), inflatedBytes, 1);
    constexpr size_t kHead = 8 + 25;  // signature and IHDR
    std::vector<uint8_t> bomb(png.begin(), png.begin() + kHead);
    const auto chunk = [&](const std::string& type, size_t size) {
        for (int shift = 24; shift >= 0; shift -= 8) bomb.push_back(uint8_t(size >> shift));
        bomb.insert(bomb.end(), type.begin(), type.end());
        bomb.insert(bomb.end(), packed.begin(), packed.begin() + std::ptrdiff_t(size));
        bomb.insert(bomb.end(), 4, 0);  // checksums that the decoder does not look at
    };
    chunk("IDAT", packedSize);
    chunk("IEND", 0);
    return bomb;
}

TEST(GltfMaterials, APictureThatInflatesBeyondItsSizeIsRefused) {
    // 2x2 texels whose compressed data hold 200 MB.
    Textured textured(pngBomb(kPng8, 200u << 20));
    textured.builder.push("materials", {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}});
    const LoadedScene loaded = load(textured.builder);
    ASSERT_EQ(loaded.notes.size(), 1u);
    EXPECT_NE(loaded.notes[0].find("cannot be decoded"), std::string::npos);
}

TEST(GltfMaterials, ExtensionsWeDoNotKnowAreNamedOnce) {
    GltfBuilder builder;
    builder.json["extensionsUsed"] = {"KHR_materials_sheen", "KHR_materials_ior"};
    for (int i = 0; i < 3; ++i)
        builder.push("materials", {{"extensions", {{"KHR_materials_sheen", {{"sheenRoughnessFactor", 1}}}}}});
    const LoadedScene loaded = load(builder);
    ASSERT_EQ(loaded.notes.size(), 1u);
    EXPECT_NE(loaded.notes[0].find("KHR_materials_sheen"), std::string::npos);

    for (const char* name : {"KHR_gaussian_splatting", "EXT_structural_metadata", "ACME_rooms"}) {
        builder.json["extensionsRequired"] = {name};
        try {
            load(builder);
            FAIL() << name;
        } catch (const FileError& error) {
            EXPECT_NE(error.reason.find(name), std::string::npos);
        }
    }
}

}  // namespace
}  // namespace phat
