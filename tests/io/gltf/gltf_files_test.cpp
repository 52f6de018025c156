// Containers, URIs, and what malformed bytes do.

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cmath>

#include "core/base/random.h"
#include "io/base/file_error.h"
#include "io/gltf/gltf_builder.h"
#include "io/gltf/gltf_loader.h"
#include "io/gltf/gltf_sound.h"
#include "support/temporary_folder.h"

namespace phat {
namespace {

using test::GltfBuilder;
using Json = nlohmann::json;

// One of everything that the loader reads, in about two kilobytes.
GltfBuilder smallScene() {
    GltfBuilder builder;
    const int positions = builder.floats("VEC3", {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0});
    const int normals =
        builder.accessor(builder.view<int8_t>({0, 0, 127, 0, 0, 0, 127, 0, 0, 0, 127, 0, 0, 0, 127, 0}, 4),
                         test::kByte, "VEC3", 4, true);
    const int uvs = builder.floats("VEC2", {0, 1, 1, 1, 0, 0, 1, 0});
    const int sparse = builder.accessor(positions, test::kFloat, "VEC3", 4);
    builder.json["accessors"][size_t(sparse)]["sparse"] = {
        {"count", 1},
        {"indices", {{"bufferView", builder.view<uint16_t>({3})}, {"componentType", 5123}}},
        {"values", {{"bufferView", builder.view<float>({2, 2, 0})}}}};
    builder.push("images", {{"bufferView", builder.view<uint8_t>({1, 2, 3})}});
    builder.push("textures", {{"source", 0}, {"sampler", 0}});
    builder.push("samplers", {{"wrapS", 33071}});
    builder.push("materials", {{"pbrMetallicRoughness",
                                {{"baseColorFactor", {1, 0, 0, 1}}, {"baseColorTexture", {{"index", 0}}}}},
                               {"extensions", {{"KHR_materials_ior", {{"ior", 1.4}}}}}});
    const int mesh =
        builder.mesh({{"attributes", {{"POSITION", sparse}, {"NORMAL", normals}, {"TEXCOORD_0", uvs}}},
                      {"indices", builder.indices({0, 1, 2, 2, 1, 3})},
                      {"material", 0}});
    builder.push("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 0.1}}}});
    builder.json["extensions"]["KHR_lights_punctual"]["lights"] =
        Json::array({{{"type", "point"}, {"intensity", 9}}});
    const int child = builder.push("nodes", {{"mesh", mesh}, {"rotation", {0, 0, 0, 1}}});
    builder.root({{"children", {child}}, {"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}}});
    builder.root({{"camera", 0}, {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
    return builder;
}

// Loads bytes that may be anything: the outcome is a sound scene or a FileError, nothing else.
enum class Outcome { loaded, refused };
Outcome tryLoad(const TemporaryFolder& folder, const std::vector<char>& bytes) {
    const std::string path = folder.file("try.glb");
    std::filesystem::remove(path);  // cutting a file to nothing waits for the disk on some file systems
    writeBytes(path, bytes);
    try {
        const LoadedScene loaded = loadGltf(path);
        EXPECT_EQ(test::countUnsound(loaded.scene), 0);
        return Outcome::loaded;
    } catch (const FileError& error) {
        EXPECT_EQ(error.path, path);
        EXPECT_FALSE(error.reason.empty());
        EXPECT_EQ(error.reason.find('\n'), std::string::npos) << error.reason;
        return Outcome::refused;
    }
}

TEST(GltfFiles, SmallSceneIsGood) {
    const TemporaryFolder folder;
    writeBytes(folder.file("a.glb"), smallScene().glb());
    const LoadedScene loaded = loadGltf(folder.file("a.glb"));
    EXPECT_EQ(loaded.scene.triangles.size(), 2u);
    EXPECT_EQ(loaded.scene.positions[3], glm::vec3(2, 2, 0));
    EXPECT_EQ(loaded.scene.cameras.size(), 1u);
    EXPECT_EQ(loaded.scene.lights.size(), 1u);
    EXPECT_EQ(loaded.notes.size(), 1u);  // three bytes are no picture
}

TEST(GltfFiles, EveryTruncationIsRefused) {
    const TemporaryFolder folder;
    const std::vector<char> whole = smallScene().glb();
    for (size_t size = 0; size < whole.size(); ++size) {
        const std::vector<char> cut(whole.begin(), whole.begin() + std::ptrdiff_t(size));
        ASSERT_EQ(tryLoad(folder, cut), Outcome::refused) << size;
    }
}

TEST(GltfFiles, EveryBitOfTheHeadersFlipped) {
    const TemporaryFolder folder;
    const std::vector<char> whole = smallScene().glb();
    const uint32_t jsonSize = uint32_t(uint8_t(whole[12])) | uint32_t(uint8_t(whole[13])) << 8;
    int refused = 0;
    const auto flip = [&](size_t byte) {
        for (int bit = 0; bit < 8; ++bit) {
            std::vector<char> bytes = whole;
            bytes[byte] = char(bytes[byte] ^ (1 << bit));
            refused += tryLoad(folder, bytes) == Outcome::refused;
        }
    };
    for (size_t byte = 0; byte < 20; ++byte) flip(byte);
    for (size_t byte = 0; byte < 8; ++byte) flip(20 + jsonSize + byte);
    // Only a shorter total length or chunk, within padding, could be harmless.
    EXPECT_GE(refused, 28 * 8 - 4);
}

TEST(GltfFiles, RandomBytesChangedInTheJson) {
    const TemporaryFolder folder;
    const GltfBuilder builder = smallScene();
    const std::vector<char> whole = builder.glb();
    const uint32_t jsonSize = uint32_t(uint8_t(whole[12])) | uint32_t(uint8_t(whole[13])) << 8;
    // Structure-preserving replacements get past the parser more often than random bytes.
    const std::string digits = "0123456789-eE.,[]{}\":";
    Rng rng(7);
    int loaded = 0, refused = 0;
    for (int i = 0; i < 4000; ++i) {
        std::vector<char> bytes = whole;
        const int changes = 1 + int(rng.bits() % 3);
        for (int k = 0; k < changes; ++k) {
            char& c = bytes[20 + rng.bits() % jsonSize];
            if (i % 4 == 0) {
                c = char(rng.bits());
            } else if (std::isdigit(static_cast<unsigned char>(c))) {
                c = digits[rng.bits() % 10];
            } else if (i % 4 == 1) {
                c = digits[rng.bits() % digits.size()];
            }
        }
        (tryLoad(folder, bytes) == Outcome::loaded ? loaded : refused) += 1;
    }
    // Both must happen, or the test tests nothing.
    EXPECT_GT(loaded, 200);
    EXPECT_GT(refused, 1000);
}

// Every value of the JSON replaced by values of every kind: reaches the checks behind the parser.
TEST(GltfFiles, EveryValueReplaced) {
    const TemporaryFolder folder;
    const GltfBuilder builder = smallScene();
    const Json flat = builder.json.flatten();
    const std::vector<Json> replacements = {
        nullptr, -1, 0, 1, 99, 4294967296, 1e300, 0.5, "text", true, Json::array(), Json::object()};
    int refused = 0;
    for (const auto& [pointer, value] : flat.items()) {
        for (const Json& replacement : replacements) {
            GltfBuilder changed = builder;
            changed.json[Json::json_pointer(pointer)] = replacement;
            refused += tryLoad(folder, changed.glb()) == Outcome::refused;
        }
    }
    EXPECT_GT(refused, int(flat.size()));
}

TEST(GltfFiles, RandomBytesChangedInTheBuffer) {
    const TemporaryFolder folder;
    const std::vector<char> whole = smallScene().glb();
    const size_t start = whole.size() - smallScene().binary.size();
    Rng rng(11);
    for (int i = 0; i < 1000; ++i) {
        std::vector<char> bytes = whole;
        for (int k = 0; k < 4; ++k) bytes[start + rng.bits() % (bytes.size() - start)] = char(rng.bits());
        tryLoad(folder, bytes);
    }
}

TEST(GltfFiles, DeepJsonIsRefused) {
    const TemporaryFolder folder;
    for (const char* nest : {"[", "{\"extras\":"}) {
        std::string text = R"({"asset":{"version":"2.0"},"extras":)";
        for (int i = 0; i < 100000; ++i) text += nest;
        EXPECT_EQ(tryLoad(folder, GltfBuilder::glbOf(text, {})), Outcome::refused);
    }
}

TEST(GltfFiles, MessagesStayOnOneShortLine) {
    const TemporaryFolder folder;
    GltfBuilder builder = smallScene();
    builder.json["images"][0]["name"] = "\x1b[31mred\nsecond line" + std::string(5000, 'x');
    writeBytes(folder.file("a.glb"), builder.glb());
    const std::string note = loadGltf(folder.file("a.glb")).notes.at(0);
    EXPECT_EQ(note.find_first_of("\x1b\n"), std::string::npos);
    EXPECT_LT(note.size(), 400u);
    builder.json["extensionsRequired"] = {"evil\nname" + std::string(5000, 'x')};
    writeBytes(folder.file("a.glb"), builder.glb());
    try {
        loadGltf(folder.file("a.glb"));
        FAIL();
    } catch (const FileError& error) {
        EXPECT_EQ(error.reason.find('\n'), std::string::npos);
        EXPECT_LT(error.reason.size(), 400u);
    }
}

TEST(GltfFiles, UnknownChunksAreIgnored) {
    const TemporaryFolder folder;
    std::vector<char> bytes = smallScene().glb();
    const std::vector<char> chunk = {4, 0, 0, 0, 'A', 'B', 'C', 'D', 1, 2, 3, 4};
    bytes.insert(bytes.end(), chunk.begin(), chunk.end());
    const uint32_t size = uint32_t(bytes.size());
    for (int i = 0; i < 4; ++i) bytes[size_t(8 + i)] = char(size >> (8 * i));
    EXPECT_EQ(tryLoad(folder, bytes), Outcome::loaded);
}

TEST(GltfFiles, DataUrisAndFilesBesideTheScene) {
    const TemporaryFolder folder;
    const GltfBuilder builder = smallScene();
    std::filesystem::create_directory(folder.path / "sub folder");
    writeBytes(folder.file("sub folder/data.bin"), builder.binary);
    for (const std::string& uri :
         {"data:application/octet-stream;base64," + test::base64(builder.binary),
          std::string("sub%20folder/data.bin"), std::string("./sub folder/data.bin")}) {
        Json json = builder.json;
        json["buffers"] = Json::array({{{"byteLength", builder.binary.size()}, {"uri", uri}}});
        const std::string text = json.dump(2);
        writeBytes(folder.file("scene.gltf"), {text.begin(), text.end()});
        const LoadedScene loaded = loadGltf(folder.file("scene.gltf"));
        EXPECT_EQ(loaded.scene.triangles.size(), 2u) << uri.substr(0, 40);
        EXPECT_EQ(loaded.scene.positions[3], glm::vec3(2, 2, 0));
    }
}

TEST(GltfFiles, NothingOutsideTheFolderIsRead) {
    const TemporaryFolder folder;
    const GltfBuilder builder = smallScene();
    std::filesystem::create_directory(folder.path / "scene");
    writeBytes(folder.file("secret.bin"), builder.binary);  // would do, if it were read
    std::filesystem::create_symlink(folder.path / "secret.bin", folder.path / "scene/link.bin");
    ASSERT_EQ(mkfifo(folder.file("scene/pipe.bin").c_str(), 0600), 0);  // opening it would wait forever
    for (const std::string& uri :
         {folder.file("secret.bin"), std::string("../secret.bin"), std::string("%2e%2e/secret.bin"),
          std::string("sub/../../secret.bin"), std::string("..\\secret.bin"), std::string("link.bin"),
          std::string("pipe.bin"), std::string("."), "file://" + folder.file("secret.bin"),
          std::string("http://127.0.0.1:9/secret.bin"), std::string("missing.bin"), std::string("a%00b")}) {
        Json json = builder.json;
        json["buffers"] = Json::array({{{"byteLength", builder.binary.size()}, {"uri", uri}}});
        std::string text = json.dump();
        writeBytes(folder.file("scene/scene.gltf"), {text.begin(), text.end()});
        EXPECT_THROW(loadGltf(folder.file("scene/scene.gltf")), FileError) << uri;

        // The same as a picture costs the picture only.
        GltfBuilder pictured = builder;
        pictured.json["images"][0] = {{"uri", uri}};
        writeBytes(folder.file("scene/scene.glb"), pictured.glb());
        const LoadedScene loaded = loadGltf(folder.file("scene/scene.glb"));
        EXPECT_EQ(loaded.scene.materials[0].baseColorTexture.image, -1) << uri;
        ASSERT_EQ(loaded.notes.size(), 1u) << uri;
    }
}

TEST(GltfFiles, WhatIsNoFile) {
    const TemporaryFolder folder;
    EXPECT_THROW(loadGltf(folder.file("missing.glb")), FileError);
    EXPECT_THROW(loadGltf(folder.path.string()), FileError);
    EXPECT_THROW(loadGltf(""), FileError);
    EXPECT_THROW(loadGltf("/dev/zero"), FileError);
}

}  // namespace
}  // namespace phat
