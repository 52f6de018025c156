// One scene in the encodings of the web, and what damage to them does (tests/data/encoded).

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "core/base/random.h"
#include "io/base/file_error.h"
#include "io/gltf/gltf_builder.h"
#include "io/gltf/gltf_loader.h"
#include "io/gltf/gltf_sound.h"
#include "support/temporary_folder.h"

namespace phat {
namespace {

std::string encoded(const std::string& name) {
    return PHAT_SOURCE_DIR "/tests/data/encoded/" + name + ".glb";
}

std::vector<char> bytesOfFile(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

LoadedScene loadSound(const std::string& name) {
    LoadedScene loaded = loadGltf(encoded(name));
    EXPECT_EQ(test::countUnsound(loaded.scene), 0) << name;
    return loaded;
}

struct Precision {
    float position, normal, uv, color;
};

// The vertices that triangles use; encoders drop the others.
std::vector<uint32_t> usedVertices(const Scene& scene) {
    std::vector<bool> used(scene.positions.size(), false);
    for (const glm::uvec3& t : scene.triangles)
        for (int corner = 0; corner < 3; ++corner) used[t[corner]] = true;
    std::vector<uint32_t> vertices;
    for (uint32_t v = 0; v < used.size(); ++v)
        if (used[v]) vertices.push_back(v);
    return vertices;
}

// Every corner of `a` has one in `b` that is the same but for the encoding's rounding.
size_t cornersWithoutTwin(const Scene& a, const Scene& b, const Precision& most) {
    size_t missing = 0;
    const std::vector<uint32_t> candidates = usedVertices(b);
    for (const uint32_t v : usedVertices(a)) {
        bool found = false;
        for (size_t i = 0; i < candidates.size() && !found; ++i) {
            const uint32_t w = candidates[i];
            found = glm::distance(a.positions[v], b.positions[w]) <= most.position &&
                    glm::distance(a.normals[v], b.normals[w]) <= most.normal &&
                    glm::distance(a.uv0[v], b.uv0[w]) <= most.uv &&
                    glm::distance(a.colors[v], b.colors[w]) <= most.color;
        }
        missing += !found;
    }
    return missing;
}

double areaOf(const Scene& scene) {
    double area = 0;
    for (const glm::uvec3& t : scene.triangles) {
        const glm::dvec3 p = scene.positions[t[0]];
        area += glm::length(glm::cross(glm::dvec3(scene.positions[t[1]]) - p,
                                       glm::dvec3(scene.positions[t[2]]) - p)) /
                2;
    }
    return area;
}

// Positions have 14 bits of the largest mesh, 12 m long: half a step on each axis. Normals have 12 bits
// (octahedral: the two halves of a step meet in a vector up to 1.5 times as long; Cigolla et al. 2014, "A
// Survey of Efficient Representations for Independent Unit Vectors", table 2), uvs 14 bits, colours the 8
// bits that they have in the plain file.
const float kStep14 = 12.0f / 16383;
const Precision kQuantised = {0.5f * std::sqrt(3.0f) * kStep14, 1.5f * std::sqrt(2.0f) * 2 / 4095,
                              1.0f / 16383, 1e-6f};
// The filter at its usual setting has normals of 8 bits, decoded to 8 bits an axis.
const Precision kFiltered = {kQuantised.position, 1.5f * std::sqrt(2.0f) / 255 + 0.5f * std::sqrt(3.0f) / 127,
                             kQuantised.uv, kQuantised.color};
const Precision kExact = {1e-6f, 1e-6f, 1e-6f, 1e-6f};

TEST(GltfEncoded, EachIsThePlainSceneWithinItsPrecision) {
    const LoadedScene plain = loadSound("plain");
    ASSERT_EQ(plain.scene.surfaces.size(), 7u);
    ASSERT_EQ(plain.scene.triangles.size(), 6u * 396 + 2);
    for (const auto& [name, precision] :
         std::vector<std::pair<std::string, Precision>>{{"draco", kQuantised},
                                                        {"draco-sequential", kQuantised},
                                                        {"meshopt", kQuantised},
                                                        {"meshopt-filters", kFiltered},
                                                        {"quantize", kQuantised},
                                                        {"instance", kExact},
                                                        {"webp", kExact},
                                                        {"avif", kExact}}) {
        const LoadedScene loaded = loadSound(name);
        EXPECT_TRUE(loaded.notes.empty()) << name << ": " << loaded.notes[0];
        EXPECT_EQ(loaded.scene.triangles.size(), plain.scene.triangles.size()) << name;
        EXPECT_EQ(loaded.scene.surfaces.size(), 7u) << name;
        EXPECT_EQ(loaded.scene.materials.size(), plain.scene.materials.size()) << name;
        EXPECT_EQ(cornersWithoutTwin(plain.scene, loaded.scene, precision), 0u) << name;
        EXPECT_EQ(cornersWithoutTwin(loaded.scene, plain.scene, precision), 0u) << name;
        EXPECT_NEAR(areaOf(loaded.scene) / areaOf(plain.scene), 1, 1e-3) << name;
        for (size_t t = 0; t < loaded.scene.triangles.size(); ++t)
            ASSERT_GT(glm::dot(test::faceNormal(loaded.scene, t),
                               loaded.scene.normals[loaded.scene.triangles[t][0]]),
                      0)
                << name;
    }
}

TEST(GltfEncoded, PicturesAreThePlainOnes) {
    const Scene plain = loadSound("plain").scene;
    ASSERT_EQ(plain.images.size(), 1u);
    // AVIF converts to luma and chroma of 8 bits, and is rounded twice on the way.
    for (const auto& [name, most] :
         std::vector<std::pair<std::string, int>>{{"webp", 0}, {"avif", 3}, {"draco", 0}}) {
        const Scene scene = loadSound(name).scene;
        ASSERT_EQ(scene.images.size(), 1u) << name;
        const TextureImage &a = *plain.images[0], &b = *scene.images[0];
        ASSERT_EQ(a.texels.size(), b.texels.size()) << name;
        int worst = 0;
        for (size_t i = 0; i < a.texels.size(); ++i)
            for (int c = 0; c < 4; ++c)
                worst = std::max(worst, std::abs(int(a.texels[i][c]) - int(b.texels[i][c])));
        EXPECT_LE(worst, most) << name;
    }
}

// Bytes of the BIN chunk changed at random, and its end cut off: a sound scene or one line, nothing else.
TEST(GltfEncoded, DamageIsRefusedOrHarmless) {
    const TemporaryFolder folder;
    const std::string path = folder.file("try.glb");
    int loaded = 0, refused = 0;
    for (const char* name :
         {"draco", "draco-sequential", "meshopt", "meshopt-filters", "webp", "avif", "instance"}) {
        const std::vector<char> whole = bytesOfFile(encoded(name));
        uint32_t jsonSize = 0;
        std::memcpy(&jsonSize, &whole[12], 4);
        const size_t start = 20 + jsonSize + 8;
        Rng rng(23);
        for (int i = 0; i < 500; ++i) {
            std::vector<char> bytes = whole;
            const size_t at = start + rng.bits() % (bytes.size() - start);
            if (i % 5 == 0) {
                std::fill(bytes.begin() + ptrdiff_t(at), bytes.end(), char(0));
            } else {
                for (int k = 0; k <= i % 4; ++k)
                    bytes[start + rng.bits() % (bytes.size() - start)] = char(rng.bits());
                bytes[at] = char(bytes[at] ^ (1 << rng.bits() % 8));
            }
            std::filesystem::remove(path);
            writeBytes(path, bytes);
            try {
                ASSERT_EQ(test::countUnsound(loadGltf(path).scene), 0) << name << i;
                ++loaded;
            } catch (const FileError& error) {
                EXPECT_FALSE(error.reason.empty());
                EXPECT_EQ(error.reason.find('\n'), std::string::npos) << error.reason;
                ++refused;
            }
        }
    }
    // Both must happen, or the test tests nothing.
    EXPECT_GT(loaded, 500);
    EXPECT_GT(refused, 500);
}

std::string reasonOf(const test::GltfBuilder& builder) {
    const TemporaryFolder folder;
    writeBytes(folder.file("a.glb"), builder.glb());
    try {
        loadGltf(folder.file("a.glb"));
    } catch (const FileError& error) {
        return error.reason;
    }
    return "loaded";
}

void appendVarint(std::vector<uint8_t>& bytes, uint64_t value) {
    for (; value > 127; value >>= 7) bytes.push_back(uint8_t(value | 128));
    bytes.push_back(uint8_t(value));
}

// Sizes that only the data claim: refused before memory is taken, which the reason says.
TEST(GltfEncoded, ClaimedSizesAreChecked) {
    for (const uint8_t method : {0, 1}) {
        std::vector<uint8_t> draco = {'D', 'R', 'A', 'C', 'O', 2, 2, 1, method, 0, 0};
        if (method == 1) draco.push_back(0);
        appendVarint(draco, 1 << 28);
        appendVarint(draco, 1 << 28);
        draco.resize(draco.size() + 200, 1);
        test::GltfBuilder builder;
        const int positions = builder.accessor(-1, test::kFloat, "VEC3", 1 << 28);
        builder.root({{"mesh", builder.mesh({{"attributes", {{"POSITION", positions}}},
                                             {"extensions",
                                              {{"KHR_draco_mesh_compression",
                                                {{"bufferView", builder.view(draco)},
                                                 {"attributes", {{"POSITION", 0}}}}}}}})}});
        EXPECT_NE(reasonOf(builder).find("out of proportion"), std::string::npos) << reasonOf(builder);
    }
    test::GltfBuilder meshopt;
    const int view = meshopt.view(std::vector<uint8_t>(100, 0xa0));
    meshopt.json["bufferViews"][size_t(view)]["extensions"]["EXT_meshopt_compression"] = {
        {"buffer", 0}, {"byteLength", 100}, {"byteStride", 16}, {"count", 1u << 31}, {"mode", "ATTRIBUTES"}};
    const int accessor = meshopt.accessor(view, test::kFloat, "VEC3", 6);
    meshopt.root({{"mesh", meshopt.mesh({{"attributes", {{"POSITION", accessor}}}})}});
    EXPECT_NE(reasonOf(meshopt).find("out of proportion"), std::string::npos) << reasonOf(meshopt);

    // A lossless WebP of 16384 x 16384.
    const std::vector<uint8_t> webp = {'R', 'I', 'F', 'F', 32, 0, 0,    0,    'W',  'E',  'B',  'P', 'V', 'P',
                                       '8', 'L', 20,  0,   0,  0, 0x2f, 0xff, 0xff, 0xff, 0x0f, 0,   0,   0,
                                       0,   0,   0,   0,   0,  0, 0,    0,    0,    0,    0,    0};
    test::GltfBuilder picture;
    picture.push("images", {{"bufferView", picture.view(webp)}, {"mimeType", "image/webp"}});
    picture.push("textures", {{"extensions", {{"EXT_texture_webp", {{"source", 0}}}}}});
    picture.push("materials", {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}});
    picture.root(
        {{"mesh",
          picture.mesh({{"attributes", {{"POSITION", picture.floats("VEC3", {0, 0, 0, 1, 0, 0, 0, 1, 0})}}},
                        {"material", 0}})}});
    EXPECT_NE(reasonOf(picture).find("out of proportion"), std::string::npos) << reasonOf(picture);
}

TEST(GltfEncoded, NewerCodecsAreNamed) {
    test::GltfBuilder builder;
    const int view = builder.view(std::vector<uint8_t>(100, 0xa1));
    const auto compress = [&](const char* filter) {
        builder.json["bufferViews"][size_t(view)]["extensions"]["KHR_meshopt_compression"] = {
            {"buffer", 0}, {"byteLength", 100},    {"byteStride", 12},
            {"count", 3},  {"mode", "ATTRIBUTES"}, {"filter", filter}};
    };
    compress("NONE");
    const int accessor = builder.accessor(view, test::kFloat, "VEC3", 3);
    builder.root({{"mesh", builder.mesh({{"attributes", {{"POSITION", accessor}}}})}});
    EXPECT_NE(reasonOf(builder).find("version 1 of the vertex codec"), std::string::npos)
        << reasonOf(builder);
}

}  // namespace
}  // namespace phat
