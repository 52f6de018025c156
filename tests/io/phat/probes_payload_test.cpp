// Light probes in a baked file, whole and damaged.

#include "io/phat/probes_payload.h"

#include <gtest/gtest.h>

#include "io/base/file_error.h"
#include "io/phat/baked_scene.h"

namespace phat {
namespace {

using nlohmann::json;

/// Two cells, one of them divided, and seven probes of noise.
LightProbes noisyProbes(bool area) {
    std::mt19937 random(7);
    LightProbes probes;
    probes.lowWorld = {-0.1f, 0.3f, 1e-3f};
    probes.cellMeters = {0.7f, 1.1f, 0.3f};
    probes.gridSize = {2, 1, 1};
    probes.cells.resize(10);
    for (ProbeCell& cell : probes.cells)
        for (uint16_t& corner : cell) corner = uint16_t(random() % 7);
    probes.cells[0] = {kDividedCell, 2, 0};
    probes.cells[3].fill(kNoProbe);
    probes.places = test::randomWords(7, random);
    probes.distances.resize(7);
    for (auto& distances : probes.distances)
        for (uint8_t& code : distances) code = uint8_t(random());
    for (auto* source : {&probes.indirect, &probes.area})
        for (int i = 0; i < 7 && (area || source == &probes.indirect); ++i)
            for (uint32_t& word : source->emplace_back()) word = uint32_t(random());
    return probes;
}

struct ProbesPayload : testing::Test {
    TemporaryFolder folder;
    std::string source = folder.file("quad.glb"), target = folder.file("quad.phat.glb");
    Scene scene;
    Bake bake;

    ProbesPayload() {
        test::GltfBuilder gltf;
        const int positions = gltf.floats("VEC3", {0, 0, 0, 2, 0, 0, 0, 0, 2});
        gltf.json["accessors"][0]["min"] = {0, 0, 0};
        gltf.json["accessors"][0]["max"] = {2, 0, 2};
        gltf.root({{"mesh", gltf.mesh({{"attributes", {{"POSITION", positions}}}})}});
        writeBytes(source, gltf.glb());
        scene = loadGltf(source).scene;
        bake = test::randomBake(scene, 1, false, 3);
    }
    void write(const LightProbes* probes) {
        BakedFileOptions options;
        options.probes = probes;
        GltfSource gltf = openGltf(source);
        loadGltf(gltf);
        writeBakedFile(target, gltf, scene, bake, test::someRecord(), options);
    }
    // The file with the description of its probes changed; why it is refused, or that it is not.
    std::string reasonOf(const std::function<void(json&)>& change) {
        const LightProbes probes = noisyProbes(true);
        write(&probes);
        const std::vector<char> bytes = readBytes(target);
        const size_t end =
            20 + (uint8_t(bytes[12]) | size_t(uint8_t(bytes[13])) << 8 | size_t(uint8_t(bytes[14])) << 16);
        json gltf = json::parse(bytes.begin() + 20, bytes.begin() + std::ptrdiff_t(end));
        change(gltf["extensions"]["PHAT_photon_accumulation_texture"]["probes"]);
        writeBytes(target, test::GltfBuilder::glbOf(gltf.dump(),
                                                    {bytes.begin() + std::ptrdiff_t(end) + 8, bytes.end()}));
        try {
            readBakedFile(target);
        } catch (const FileError& error) {
            EXPECT_EQ(error.path, target);
            return error.reason;
        }
        return "loads";
    }
};

TEST_F(ProbesPayload, RoundTrips) {
    for (const bool area : {true, false}) {
        const LightProbes probes = noisyProbes(area);
        ASSERT_TRUE(isConsistent(probes));
        write(&probes);
        const LightProbes back = readBakedFile(target).probes;
        EXPECT_EQ(back.lowWorld, probes.lowWorld);
        EXPECT_EQ(back.cellMeters, probes.cellMeters);
        EXPECT_EQ(back.gridSize, probes.gridSize);
        EXPECT_EQ(back.cells, probes.cells);
        EXPECT_EQ(back.places, probes.places);
        EXPECT_EQ(back.indirect, probes.indirect);
        EXPECT_EQ(back.area, probes.area);
        EXPECT_EQ(back.distances, probes.distances);
    }
}

TEST_F(ProbesPayload, MayBeAbsent) {
    write(nullptr);
    EXPECT_EQ(readBakedFile(target).probes.count(), 0u);
    const LightProbes none;
    write(&none);
    EXPECT_EQ(readBakedFile(target).probes.count(), 0u);
}

TEST_F(ProbesPayload, DamageIsRefused) {
    EXPECT_EQ(reasonOf([](json&) {}), "loads");
    const std::vector<std::function<void(json&)>> damages = {
        [](json& p) { p["count"] = 8; },
        [](json& p) { p["count"] = 65'535; },
        [](json& p) { p["count"] = 1e18; },
        [](json& p) { p["cellCount"] = 9; },
        [](json& p) { p["cellCount"] = -1; },
        [](json& p) {
            p["grid"] = {11, 1, 1};
        },
        [](json& p) {
            p["grid"] = {0, 1, 1};
        },
        [](json& p) {
            p["grid"] = {1.5, 1, 1};
        },
        [](json& p) {
            p["grid"] = {40'000, 40'000, 40'000};
        },
        [](json& p) {
            p["grid"] = {1, 1};
        },
        [](json& p) {
            p["cellSize"] = {0, 1, 1};
        },
        [](json& p) {
            p["cellSize"] = {1, -1, 1};
        },
        [](json& p) {
            p["low"] = {1e300, 0, 0};
        },
        [](json& p) { p["low"] = "here"; },
        [](json& p) { p.erase("distances"); },
        [](json& p) { p["cells"] = p["indirect"]; },
        [](json& p) { p["area"]["bufferView"] = 9999; },
    };
    for (size_t i = 0; i < damages.size(); ++i) EXPECT_NE(reasonOf(damages[i]), "loads") << "damage " << i;
}

}  // namespace
}  // namespace phat
