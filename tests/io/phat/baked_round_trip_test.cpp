#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "core/phatexel/direction_cells.h"
#include "io/base/file_error.h"
#include "io/gltf/gltf_rewrite.h"
#include "io/gltf/gltf_source.h"
#include "io/phat/bake_journal.h"
#include "io/phat/baked_scene.h"

namespace phat {
namespace {

template <class T>
bool sameBytes(const std::vector<T>& a, const std::vector<T>& b) {
    return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

void expectSame(const Atlas& a, const Atlas& b) {
    EXPECT_LT(a.finestTexelSizeMeters(), a.texelSizeMeters);
    EXPECT_EQ(a.sizeTexels, b.sizeTexels);
    EXPECT_EQ(a.texelSizeMeters, b.texelSizeMeters);
    EXPECT_NE(a.unitMeters, 1);
    EXPECT_EQ(a.unitMeters, b.unitMeters);
    ASSERT_EQ(a.charts.size(), b.charts.size());
    for (size_t i = 0; i < a.charts.size(); ++i) {
        EXPECT_EQ(a.charts[i].originTile, b.charts[i].originTile);
        EXPECT_EQ(a.charts[i].sizeTiles, b.charts[i].sizeTiles);
        EXPECT_EQ(a.charts[i].texelSizeMeters, b.charts[i].texelSizeMeters);
        EXPECT_EQ(a.charts[i].surface, b.charts[i].surface);
        EXPECT_EQ(a.charts[i].firstBlock, b.charts[i].firstBlock);
        EXPECT_EQ(a.charts[i].back, b.charts[i].back);
        EXPECT_EQ(a.charts[i].otherSide, b.charts[i].otherSide);
    }
    EXPECT_EQ(a.triangleChart, b.triangleChart);
    EXPECT_TRUE(sameBytes(a.triangleTexels, b.triangleTexels));
    EXPECT_EQ(a.tileChart, b.tileChart);
    EXPECT_EQ(a.blockCount, b.blockCount);
}

void expectSame(const TexelPoints& a, const TexelPoints& b) {
    EXPECT_EQ(a.state, b.state);
    EXPECT_TRUE(sameBytes(a.position, b.position));
    EXPECT_TRUE(sameBytes(a.normal, b.normal));
    EXPECT_TRUE(sameBytes(a.tangent, b.tangent));
    EXPECT_EQ(a.triangle, b.triangle);
    EXPECT_TRUE(sameBytes(a.barycentric, b.barycentric));
}

void expectSame(const std::vector<PhatexelLayer>& a, const std::vector<PhatexelLayer>& b) {
    ASSERT_EQ(a.size(), b.size());
    for (size_t i = 0; i < a.size(); ++i) {
        EXPECT_TRUE(sameBytes(a[i].texels, b[i].texels));
        EXPECT_TRUE(sameBytes(a[i].pdf, b[i].pdf));
        EXPECT_EQ(a[i].scrambles, b[i].scrambles);
    }
}

void expectSame(const Phatexture& a, const Phatexture& b) {
    expectSame(a.indirect, b.indirect);
    expectSame(a.area, b.area);
    EXPECT_TRUE(sameBytes(a.indirectGuides, b.indirectGuides));
    EXPECT_TRUE(sameBytes(a.areaGuides, b.areaGuides));
    EXPECT_EQ(a.areaIrradiance, b.areaIrradiance);
    EXPECT_EQ(a.indirectIrradiance, b.indirectIrradiance);
    EXPECT_TRUE(sameBytes(a.tilePatches, b.tilePatches));
    EXPECT_TRUE(sameBytes(a.probes, b.probes));
}

// Corner by corner, because vertices may be split and numbered anew.
void expectSameCorners(const Scene& a, const Scene& b) {
    ASSERT_EQ(a.triangles.size(), b.triangles.size());
    EXPECT_EQ(a.triangleSurface, b.triangleSurface);
    for (size_t t = 0; t < a.triangles.size(); ++t)
        for (int corner = 0; corner < 3; ++corner) {
            const uint32_t i = a.triangles[t][corner], j = b.triangles[t][corner];
            ASSERT_EQ(a.positions[i], b.positions[j]) << t;
            ASSERT_EQ(a.normals[i], b.normals[j]) << t;
            ASSERT_EQ(a.uv0[i], b.uv0[j]) << t;
        }
}

struct BakedRoundTrip : testing::Test {
    TemporaryFolder folder;
    std::string source = folder.file("hard.glb");
    std::string target = folder.file("hard.phat.glb");

    BakedRoundTrip() { writeBytes(source, test::hardScene().glb()); }
};

TEST_F(BakedRoundTrip, ReturnsTheBakeBitByBit) {
    const LoadedScene loaded = loadGltf(source);
    ASSERT_EQ(loaded.scene.surfaces.size(), 7u);
    for (const bool withPdf : {false, true}) {
        const Bake bake = test::randomBake(loaded.scene, withPdf ? 1 : 3, withPdf, 7);
        writeBakedFile(target, source, loaded.scene, bake, test::someRecord());
        ASSERT_TRUE(isBakedFile(target));
        const BakedScene read = readBakedFile(target);
        expectSameCorners(loaded.scene, read.loaded.scene);
        expectSame(bake.atlas, read.atlas);
        expectSame(bake.points, read.points);
        expectSame(bake.phatexture, read.phatexture);
        ASSERT_TRUE(read.bvh);
        const SceneBvh bvh = buildSceneBvh(loaded.scene);
        EXPECT_EQ(bvh.nodes, read.bvh->nodes);
        EXPECT_EQ(bvh.order, read.bvh->order);
        EXPECT_EQ(bvh.triangles, read.bvh->triangles);
        EXPECT_EQ(read.record.generator, test::someRecord().generator);
        EXPECT_EQ(read.record.source, test::someRecord().source);
        EXPECT_EQ(read.record.settings, test::someRecord().settings);
        EXPECT_EQ(read.record.seed, test::someRecord().seed);
    }
    EXPECT_FALSE(isBakedFile(source));
}

// Charts whose pieces are of several surfaces raise the version, whatever the storage.
TEST_F(BakedRoundTrip, ChartsOfSeveralSurfacesHaveAVersionOfTheirOwn) {
    const LoadedScene loaded = loadGltf(source);
    const std::vector<Surface>& surfaces = loaded.scene.surfaces;
    for (const auto storage : {PhatexelStorage::packed, PhatexelStorage::paper}) {
        BakeRecord record = test::someRecord();
        record.storage = storage;
        Bake bake = test::randomBake(loaded.scene, 1, false, 7);
        const auto versionAfterWriting = [&] {
            writeBakedFile(target, source, loaded.scene, bake, record);
            return openGltf(target).json["extensions"][kPhatExtension]["version"].get<int>();
        };
        // As if a chart began with a piece of the mesh's other primitive.
        constexpr uint32_t kOther = 2;
        const auto pair =
            std::find_if(bake.atlas.charts.begin(), bake.atlas.charts.end(), [&](const Chart& c) {
                return c.surface + kOther < surfaces.size() &&
                       surfaces[c.surface].node == surfaces[c.surface + kOther].node;
            });
        ASSERT_NE(pair, bake.atlas.charts.end());
        pair->surface += kOther;
        EXPECT_EQ(versionAfterWriting(), 5);
        const BakedScene read = readBakedFile(target);
        EXPECT_EQ(read.record.storage, storage);
        expectSame(bake.atlas, read.atlas);
        EXPECT_EQ(read.atlas.triangleSurface, loaded.scene.triangleSurface);

        --pair->surface;
        ASSERT_NE(surfaces[pair->surface].node, surfaces[pair->surface + 1].node);
        versionAfterWriting();
        EXPECT_THROW(readBakedFile(target), FileError);
    }
}

// Half angles beside a cell's border (.19 degrees, see PackedPhatexel16), 24 bits (.06), and what keeps the
// direction clear of the border: a hundredth of a cell, which is at most .25 radians wide.
constexpr float kPaperRadians = 0.0034f + 0.0011f + 0.0026f;

void expectSameButDistance(const std::vector<PackedPhatexel>& before,
                           const std::vector<PackedPhatexel>& after) {
    ASSERT_EQ(before.size(), after.size());
    size_t valid = 0;
    for (size_t i = 0; i < before.size(); ++i) {
        const Phatexel a = unpackPhatexel(before[i], 1), b = unpackPhatexel(after[i], 1);
        ASSERT_EQ(a.valid, b.valid);
        if (!a.valid) continue;
        ASSERT_EQ(a.radiance, b.radiance);
        ASSERT_EQ(b.distance, kFarDistance);
        // Noise has codes of directions under the horizon, which no bake has.
        if (std::abs(glm::length(a.directionBlock) - 1) > 1e-3f) continue;
        ASSERT_LT(glm::distance(a.directionBlock, b.directionBlock), kPaperRadians);
        ASSERT_EQ(cellOfDirection(a.directionBlock), cellOfDirection(b.directionBlock));
        ++valid;
    }
    EXPECT_GT(valid, before.size() / 3);
}

TEST_F(BakedRoundTrip, ThePapersStorageReturnsAllButTheDistances) {
    const LoadedScene loaded = loadGltf(source);
    BakeRecord record = test::someRecord();
    record.storage = PhatexelStorage::paper;
    for (const bool withPdf : {false, true}) {
        Bake bake = test::randomBake(loaded.scene, withPdf ? 1 : 3, withPdf, 7);
        writeBakedFile(target, source, loaded.scene, bake, record);
        const nlohmann::json extension = openGltf(target).json["extensions"][kPhatExtension];
        EXPECT_EQ(extension["version"], 4);
        EXPECT_EQ(extension["storage"], "paper");
        const auto& layer = extension["indirect"]["layers"][0];
        EXPECT_EQ(layer["phatexels"]["byteLength"], 16 * bake.atlas.texelCount());
        EXPECT_EQ(layer.contains("pdf"), withPdf);
        BakedScene read = readBakedFile(target);
        EXPECT_EQ(read.record.storage, PhatexelStorage::paper);
        for (auto layers : {&Phatexture::indirect, &Phatexture::area}) {
            ASSERT_EQ((bake.phatexture.*layers).size(), (read.phatexture.*layers).size());
            for (size_t i = 0; i < (bake.phatexture.*layers).size(); ++i) {
                PhatexelLayer &before = (bake.phatexture.*layers)[i], &after = (read.phatexture.*layers)[i];
                expectSameButDistance(before.texels, after.texels);
                before.texels = after.texels = {};
            }
        }
        expectSame(bake.phatexture, read.phatexture);
    }
    writeBakedFile(target, source, loaded.scene, test::randomBake(loaded.scene, 1, false, 7),
                   test::someRecord());
    const nlohmann::json extension = openGltf(target).json["extensions"][kPhatExtension];
    EXPECT_EQ(extension["version"], 3);
    EXPECT_FALSE(extension.contains("storage"));
    EXPECT_EQ(readBakedFile(target).record.storage, PhatexelStorage::packed);
}

TEST_F(BakedRoundTrip, WritesTheSameBytesTwice) {
    const LoadedScene loaded = loadGltf(source);
    const Bake bake = test::randomBake(loaded.scene, 2, false, 1);
    writeBakedFile(target, source, loaded.scene, bake, test::someRecord());
    const auto first = readBytes(target);
    writeBakedFile(target, source, loaded.scene, bake, test::someRecord());
    EXPECT_EQ(first, readBytes(target));
    EXPECT_EQ(folder.fileCount(), 2u);
}

// A bake reads its input once: loading, fingerprint and writing share what was opened.
TEST_F(BakedRoundTrip, NeedsTheInputFileOnlyWhileItIsOpened) {
    const auto fingerprintOf = [](const GltfSource& opened) {
        Fingerprint fingerprint;
        addGltf(fingerprint, opened);
        return fingerprint.value();
    };
    GltfSource opened = openGltf(source);
    const LoadedScene loaded = loadGltf(opened);
    const Bake bake = test::randomBake(loaded.scene, 1, false, 4);
    writeBakedFile(target, source, loaded.scene, bake, test::someRecord());
    const auto expected = readBytes(target);
    const uint64_t fingerprint = fingerprintOf(opened);

    std::filesystem::remove(source);
    EXPECT_EQ(fingerprintOf(opened), fingerprint);
    writeBakedFile(target, opened, loaded.scene, bake, test::someRecord());
    EXPECT_EQ(readBytes(target), expected);

    GltfSource again = openGltf(target);
    std::filesystem::remove(target);
    ASSERT_TRUE(isBakedFile(again));
    expectSame(bake.phatexture, readBakedFile(again).phatexture);
    EXPECT_NE(fingerprintOf(again), fingerprint);
}

// A file that is baked again carries one extension and one atlas UV set, not two.
TEST_F(BakedRoundTrip, ReplacesAnEarlierBake) {
    const LoadedScene loaded = loadGltf(source);
    writeBakedFile(target, source, loaded.scene, test::randomBake(loaded.scene, 1, false, 1),
                   test::someRecord());
    const LoadedScene again = readBakedFile(target).loaded;
    const Bake bake = test::randomBake(again.scene, 2, false, 2);
    const std::string second = folder.file("second.glb");
    writeBakedFile(second, target, again.scene, bake, test::someRecord());
    expectSame(bake.phatexture, readBakedFile(second).phatexture);
    const auto json = openGltf(second).json;
    EXPECT_EQ(json["extensions"]["PHAT_photon_accumulation_texture"]["texCoord"], 2);
    for (const auto& mesh : json["meshes"])
        for (const auto& primitive : mesh["primitives"])
            EXPECT_FALSE(primitive["attributes"].contains("TEXCOORD_3"));
}

TEST_F(BakedRoundTrip, KeepsTheRestOfTheFile) {
    const LoadedScene loaded = loadGltf(source);
    writeBakedFile(target, source, loaded.scene, test::randomBake(loaded.scene, 1, false, 1),
                   test::someRecord());
    const auto before = openGltf(source).json, after = openGltf(target).json;
    for (const char* key :
         {"asset", "cameras", "extensionsRequired", "extras", "materials", "scene", "scenes"})
        EXPECT_EQ(before[key], after[key]) << key;
    EXPECT_EQ(before["extensions"]["KHR_lights_punctual"], after["extensions"]["KHR_lights_punctual"]);
    ASSERT_EQ(before["nodes"].size(), after["nodes"].size());
    std::set<int> meshes;
    for (size_t i = 0; i < before["nodes"].size(); ++i) {
        auto a = before["nodes"][i], b = after["nodes"][i];
        if (b.contains("mesh")) {
            EXPECT_TRUE(meshes.insert(b["mesh"].get<int>()).second);
        }
        a.erase("mesh");
        b.erase("mesh");
        EXPECT_EQ(a, b);
    }
    // The cube stays quantised: 16-bit positions, 8-bit normals.
    GltfSource file = openGltf(target);
    readGltfBuffers(file);
    const auto& attributes =
        after["meshes"][after["nodes"][0]["mesh"].get<size_t>()]["primitives"][0]["attributes"];
    EXPECT_EQ(readAccessor(file, attributes["POSITION"].get<uint64_t>()).componentType, 5122u);
    EXPECT_EQ(readAccessor(file, attributes["NORMAL"].get<uint64_t>()).componentType, 5120u);
    EXPECT_EQ(after["accessors"][attributes["POSITION"].get<size_t>()]["max"],
              nlohmann::json({1000, 1000, 1000}));
}

TEST_F(BakedRoundTrip, CarriesTheEnvironment) {
    LoadedScene loaded = loadGltf(source);
    Image sky(4, 2, glm::vec3(0.25f, 0.5f, 1));
    sky.at(1, 0) = glm::vec3(4e6f);  // a sun beyond what RGB9E5 reaches
    loaded.scene.environment = Environment{sky};
    writeBakedFile(target, source, loaded.scene, test::randomBake(loaded.scene, 1, false, 1),
                   test::someRecord());
    const auto read = readBakedFile(target).loaded.scene.environment;
    ASSERT_TRUE(read);
    EXPECT_NEAR(read->radiance.at(1, 0).y, 4e6f, 4e6f / 512);
    // Half a step of the 9-bit mantissa of the largest channel.
    EXPECT_NEAR(read->radiance.at(0, 0).z, 1.0f, 1.0f / 512);
}

TEST_F(BakedRoundTrip, DropsDeformationAndSaysSo) {
    test::GltfBuilder gltf = test::hardScene();
    auto& primitive = gltf.json["meshes"][0]["primitives"][0];
    primitive["targets"] = {{{"POSITION", gltf.floats("VEC3", std::vector<float>(72, 1.0f))}}};
    gltf.json["meshes"][0]["weights"] = {0.0};
    const int times = gltf.floats("SCALAR", {0, 1}), weights = gltf.floats("SCALAR", {0, 1});
    gltf.json["accessors"][times]["min"] = {0};
    gltf.json["accessors"][times]["max"] = {1};
    gltf.push("animations",
              {{"samplers", {{{"input", times}, {"output", weights}}}},
               {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "weights"}}}}}}});
    writeBytes(source, gltf.glb());
    const LoadedScene loaded = loadGltf(source);
    const auto notes = writeBakedFile(target, source, loaded.scene,
                                      test::randomBake(loaded.scene, 1, false, 1), test::someRecord());
    EXPECT_EQ(notes.size(), 2u);
    const auto json = openGltf(target).json;
    EXPECT_FALSE(json.contains("animations"));
    for (const auto& mesh : json["meshes"]) EXPECT_FALSE(mesh.contains("weights"));
    expectSameCorners(loaded.scene, readBakedFile(target).loaded.scene);
}

}  // namespace
}  // namespace phat
