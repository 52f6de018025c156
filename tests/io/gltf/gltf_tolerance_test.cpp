// What nothing uses cannot refuse a file, and names of files as people write them.

#include <gtest/gtest.h>

#include <filesystem>

#include "io/base/file_error.h"
#include "io/gltf/gltf_builder.h"
#include "io/gltf/gltf_loader.h"
#include "io/gltf/gltf_sound.h"
#include "io/gltf/gltf_source.h"
#include "io/phat/baked_scene.h"
#include "support/temporary_folder.h"

namespace phat {
namespace {

using test::GltfBuilder;
using Json = nlohmann::json;

// A file of one triangle, in which broken things can be put beside it.
GltfBuilder sound() {
    GltfBuilder builder;
    builder.push("materials", {{"name", "used"}});
    const int mesh =
        builder.mesh({{"attributes", {{"POSITION", builder.floats("VEC3", {0, 0, 0, 1, 0, 0, 0, 1, 0})}}},
                      {"material", 0}});
    builder.root({{"mesh", mesh}, {"name", "shown"}});
    return builder;
}

struct Broken {
    const char* what;
    void (*put)(GltfBuilder&);
};

const std::vector<Broken> kUnused = {
    {"texture",
     [](GltfBuilder& b) {
         b.push("textures", {{"source", 5}});
     }},
    {"texture of no object", [](GltfBuilder& b) { b.push("textures", 5); }},
    {"image",
     [](GltfBuilder& b) {
         b.push("images", {{"bufferView", 99}});
     }},
    {"image of wrong type",
     [](GltfBuilder& b) {
         b.push("images", {{"uri", 7}});
     }},
    {"sampler",
     [](GltfBuilder& b) {
         b.push("samplers", {{"wrapS", "around"}});
     }},
    {"material",
     [](GltfBuilder& b) {
         b.push("materials", {{"normalTexture", {{"index", 9}}}});
     }},
    {"material of wrong type",
     [](GltfBuilder& b) {
         b.push("materials", {{"emissiveFactor", "bright"}});
     }},
    {"texture without an index",
     [](GltfBuilder& b) {
         b.push("materials", {{"normalTexture", Json::object()}});
     }},
    {"accessor",
     [](GltfBuilder& b) {
         b.push("accessors", {{"componentType", 1}, {"type", "VEC3"}, {"count", 0}});
     }},
    {"accessor past its view", [](GltfBuilder& b) { b.accessor(0, test::kFloat, "VEC3", 1000); }},
    {"bufferView",
     [](GltfBuilder& b) {
         b.push("bufferViews", {{"buffer", 9}, {"byteLength", 5}});
     }},
    {"bufferView past its buffer",
     [](GltfBuilder& b) {
         b.push("bufferViews", {{"buffer", 0}, {"byteLength", 1 << 20}});
     }},
    {"mesh",
     [](GltfBuilder& b) {
         b.mesh({{"attributes", {{"POSITION", 99}}}});
     }},
    {"mesh without primitives", [](GltfBuilder& b) { b.push("meshes", Json::object()); }},
    {"mesh of mode 99",
     [](GltfBuilder& b) {
         b.mesh({{"attributes", {{"POSITION", 0}}}, {"mode", 99}});
     }},
    {"compressed mesh",
     [](GltfBuilder& b) {
         b.mesh({{"attributes", {{"POSITION", 0}}},
                 {"extensions",
                  {{"KHR_draco_mesh_compression", {{"bufferView", 0}, {"attributes", {{"POSITION", 0}}}}}}}});
     }},
    {"compressed view",
     [](GltfBuilder& b) {
         b.push("bufferViews", {{"buffer", 0},
                                {"byteLength", 12},
                                {"extensions",
                                 {{"EXT_meshopt_compression",
                                   {{"buffer", 0}, {"byteLength", 9}, {"byteStride", 4}, {"count", 3}}}}}});
     }},
    {"node",
     [](GltfBuilder& b) {
         b.push("nodes", {{"mesh", 77}, {"children", {55}}});
     }},
    {"node of a wrong matrix",
     [](GltfBuilder& b) {
         b.push("nodes", {{"matrix", {1, 2}}});
     }},
    {"nodes in a circle",
     [](GltfBuilder& b) {
         b.push("nodes", {{"children", {2}}});
         b.push("nodes", {{"children", {1}}});
     }},
    {"second scene",
     [](GltfBuilder& b) {
         b.push("scenes", {{"nodes", {99}}});
     }},
    {"skin",
     [](GltfBuilder& b) {
         b.push("skins", {{"joints", {99}}, {"inverseBindMatrices", 99}});
     }},
    {"skin without joints", [](GltfBuilder& b) { b.push("skins", Json::object()); }},
    {"camera",
     [](GltfBuilder& b) {
         b.push("cameras", {{"type", "none"}});
     }},
    {"light",
     [](GltfBuilder& b) {
         b.json["extensions"]["KHR_lights_punctual"]["lights"] = Json::array({Json{{"type", 3}}});
     }},
    {"animation",
     [](GltfBuilder& b) {
         b.push(
             "animations",
             {{"samplers", Json::array({{{"input", 98}, {"output", 99}}})},
              {"channels", Json::array({{{"sampler", 0}, {"target", {{"node", 0}, {"path", "scale"}}}}})}});
     }},
    {"custom attribute",
     [](GltfBuilder& b) { b.json["meshes"][0]["primitives"][0]["attributes"]["_THICKNESS"] = 99; }},
    {"sixth uv set",
     [](GltfBuilder& b) { b.json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_5"] = 99; }},
};

TEST(GltfTolerance, WhatNothingUsesMayBeBroken) {
    const TemporaryFolder folder;
    const std::string path = folder.file("a.glb"), target = folder.file("a.phat.glb");
    for (const Broken& broken : kUnused) {
        GltfBuilder builder = sound();
        broken.put(builder);
        writeBytes(path, builder.glb());
        GltfSource source = openGltf(path);
        try {
            const LoadedScene loaded = loadGltf(source);
            EXPECT_EQ(test::countUnsound(loaded.scene), 0) << broken.what;
            EXPECT_EQ(loaded.scene.triangles.size(), 1u) << broken.what;
            EXPECT_EQ(loaded.scene.materials.at(loaded.scene.surfaces.at(0).material).name, "used")
                << broken.what;
            EXPECT_LE(loaded.notes.size(), 2u) << broken.what;
            // What is written again can be read.
            writeBakedFile(target, source, loaded.scene, test::randomBake(loaded.scene, 1, false, 3),
                           test::someRecord());
            EXPECT_EQ(readBakedFile(target).loaded.scene.triangles.size(), 1u) << broken.what;
        } catch (const FileError& error) {
            ADD_FAILURE() << broken.what << ": " << error.reason;
        }
    }
}

TEST(GltfTolerance, WhatIsUsedMayNotAndTheReasonIsItsOwn) {
    struct Refused {
        void (*put)(GltfBuilder&);
        const char* reason;
    };
    for (const Refused& refused : std::vector<Refused>{
             {[](GltfBuilder& b) { b.json["meshes"][0]["primitives"][0]["material"] = 7; },
              "material 7 does not exist"},
             {[](GltfBuilder& b) { b.json["accessors"][0]["count"] = 1000; }, "lies outside its buffer view"},
             {[](GltfBuilder& b) { b.json["nodes"][0]["mesh"] = 7; }, "meshes[7]"},
             {[](GltfBuilder& b) { b.json["materials"][0]["normalTexture"]["index"] = 9; },
              "texture 9 does not exist"},
             {[](GltfBuilder& b) { b.json["scenes"][0]["nodes"] = {99}; }, "99"},
         }) {
        GltfBuilder builder = sound();
        refused.put(builder);
        builder.push("textures", {{"source", 5}});  // and something broken that nothing uses
        const TemporaryFolder folder;
        writeBytes(folder.file("a.glb"), builder.glb());
        try {
            loadGltf(folder.file("a.glb"));
            ADD_FAILURE() << refused.reason;
        } catch (const FileError& error) {
            EXPECT_NE(error.reason.find(refused.reason), std::string::npos) << error.reason;
        }
    }
}

TEST(GltfTolerance, AMissingBufferCountsWhereItIsUsed) {
    const TemporaryFolder folder;
    GltfBuilder builder = sound();
    Json json = builder.json;
    json["buffers"] = Json::array({{{"byteLength", builder.binary.size()}, {"uri", "a.bin"}},
                                   {{"byteLength", 100}, {"uri", "gone.bin"}}});
    writeBytes(folder.file("a.bin"), builder.binary);
    const auto load = [&] {
        const std::string text = json.dump();
        writeBytes(folder.file("a.gltf"), {text.begin(), text.end()});
        return loadGltf(folder.file("a.gltf"));
    };
    EXPECT_TRUE(load().notes.empty());
    json["bufferViews"].push_back({{"buffer", 1}, {"byteLength", 100}});
    EXPECT_EQ(load().scene.triangles.size(), 1u);
    json["bufferViews"][0]["buffer"] = 1;
    try {
        load();
        FAIL();
    } catch (const FileError& error) {
        EXPECT_NE(error.reason.find("gone.bin\": no such file"), std::string::npos) << error.reason;
    }
}

const std::vector<uint8_t> kPng = {
    0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d, 0x49, 0x48, 0x44, 0x52, 0x00,
    0x00, 0x00, 0x01, 0x00, 0x00, 0x00, 0x01, 0x08, 0x00, 0x00, 0x00, 0x00, 0x3a, 0x7e, 0x9b, 0x55, 0x00,
    0x00, 0x00, 0x0a, 0x49, 0x44, 0x41, 0x54, 0x78, 0x9c, 0x63, 0xf8, 0x0f, 0x00, 0x01, 0x01, 0x01, 0x00,
    0x1b, 0xb6, 0xee, 0x56, 0x00, 0x00, 0x00, 0x00, 0x49, 0x45, 0x4e, 0x44, 0xae, 0x42, 0x60, 0x82};

LoadedScene loadPictured(const TemporaryFolder& folder, const std::string& uri) {
    GltfBuilder builder = sound();
    builder.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["index"] = 0;
    builder.push("textures", {{"source", 0}});
    builder.push("images", {{"uri", uri}});
    writeBytes(folder.file("a.glb"), builder.glb());
    return loadGltf(folder.file("a.glb"));
}

TEST(GltfUris, NamesAsProgramsWriteThem) {
    const TemporaryFolder folder;
    std::filesystem::create_directories(folder.path / "sub/dir");
    struct Named {
        const char *file, *uri;
    };
    for (const auto& [file, uri] : std::vector<Named>{{"a b.png", "a b.png"},
                                                      {"a b.png", "a%20b.png"},
                                                      {"sub/dir/a.png", "sub\\dir\\a.png"},
                                                      {"c.png", "sub/../c.png"},
                                                      {"c.png", "sub/dir/..\\../c.png"},
                                                      {"c.png", "./c.png"},
                                                      {"ü.png", "ü.png"},
                                                      {"ü.png", "%C3%BC.png"},
                                                      {"p+q.png", "p+q.png"},
                                                      {"h#1.png", "h%231.png"},
                                                      {"h#2.png", "h#2.png"},
                                                      {"q?.png", "q%3F.png"},
                                                      {"v.png", "v.png?version=2"},
                                                      {"100%.png", "100%.png"},
                                                      {"50%25.png", "50%2525.png"},
                                                      {"sp%41.png", "sp%41.png"},
                                                      {"Case.PNG", "case.png"}}) {
        writeBytes(folder.file(file), {kPng.begin(), kPng.end()});
        const LoadedScene loaded = loadPictured(folder, uri);
        EXPECT_EQ(loaded.scene.images.size(), 1u) << uri;
        EXPECT_TRUE(loaded.notes.empty()) << uri << ": " << loaded.notes[0];
        std::filesystem::remove(folder.file(file));
        const LoadedScene missing = loadPictured(folder, uri);
        ASSERT_EQ(missing.notes.size(), 1u) << uri;
        EXPECT_NE(missing.notes[0].find("no such file"), std::string::npos) << missing.notes[0];
    }
}

TEST(GltfUris, DataUrisOfEveryForm) {
    const TemporaryFolder folder;
    const std::string data = test::base64({kPng.begin(), kPng.end()});
    std::string broken = data, escaped;
    broken.insert(20, "\r\n ");
    for (const char c : data)
        escaped += c == '=' ? "%3D" : c == '+' ? "%2B" : c == '/' ? "%2f" : std::string(1, c);
    std::string percent = "data:image/png,";
    for (const uint8_t byte : kPng) {
        const char* digits = "0123456789abcdef";
        percent += {'%', digits[byte >> 4], digits[byte & 15]};
    }
    for (const std::string& uri :
         {"data:image/png;base64," + data, "DATA:image/png;base64," + data, "data:image/png;BASE64," + data,
          "data:;base64," + data, "data:image/png;charset=utf-8;base64," + data,
          "data:image/png;base64," + broken, "data:image/png;base64," + escaped,
          "data:image/png;base64," + data.substr(0, data.find('=')), percent}) {
        const LoadedScene loaded = loadPictured(folder, uri);
        EXPECT_EQ(loaded.scene.images.size(), 1u) << uri;
        EXPECT_TRUE(loaded.notes.empty()) << uri << ": " << loaded.notes[0];
    }
    EXPECT_NE(loadPictured(folder, "data:image/png;base64,a*b").notes.at(0).find("not valid base64"),
              std::string::npos);
}

TEST(GltfContainers, ByteOrderMarksTrailingBytesAndMinorVersions) {
    const TemporaryFolder folder;
    GltfBuilder builder = sound();
    builder.json["asset"] = {{"version", "2.1"}, {"minVersion", "2.0"}};
    std::vector<char> bytes = builder.glb();
    bytes.insert(bytes.end(), 37, 'x');
    writeBytes(folder.file("a.glb"), bytes);
    EXPECT_EQ(loadGltf(folder.file("a.glb")).scene.triangles.size(), 1u);
    Json json = builder.json;
    json["buffers"] =
        Json::array({{{"byteLength", builder.binary.size()},
                      {"uri", "data:application/octet-stream;base64," + test::base64(builder.binary)}}});
    const std::string text = "\xEF\xBB\xBF" + json.dump();
    writeBytes(folder.file("a.gltf"), {text.begin(), text.end()});
    EXPECT_EQ(loadGltf(folder.file("a.gltf")).scene.triangles.size(), 1u);
    builder.json["asset"] = {{"version", "2.1"}, {"minVersion", "2.1"}};
    writeBytes(folder.file("a.glb"), builder.glb());
    EXPECT_THROW(loadGltf(folder.file("a.glb")), FileError);
}

}  // namespace
}  // namespace phat
