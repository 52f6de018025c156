#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cmath>
#include <glm/gtc/packing.hpp>
#include <nlohmann/json.hpp>

#include "io/base/file_error.h"
#include "io/phat/baked_scene.h"
#include "io/phat/paper_storage.h"
#include "io/phat/phat_payload.h"

namespace phat {
namespace {

// Loads, or says why not; anything else fails the test by its exception or its crash.
bool loads(const std::string& path) {
    try {
        const BakedScene baked = readBakedFile(path);
        for (const TexelState state : baked.points.state) EXPECT_LE(state, TexelState::occluded);
        return true;
    } catch (const FileError& error) {
        EXPECT_EQ(error.path, path);
        EXPECT_FALSE(error.reason.empty());
        EXPECT_EQ(error.reason.find('\n'), std::string::npos) << error.reason;
        return false;
    }
}

std::string reasonOf(const std::string& path) {
    try {
        readBakedFile(path);
    } catch (const FileError& error) {
        return error.reason;
    }
    return "loads";
}

long peakKilobytes() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return usage.ru_maxrss;
}

/// One quad, baked at a few hundred texels.
struct BakedDamage : testing::Test {
    TemporaryFolder folder;
    std::string source = folder.file("quad.glb");
    std::string target = folder.file("quad.phat.glb");
    std::vector<char> bytes;
    size_t jsonEnd = 0;

    BakedDamage() {
        test::GltfBuilder gltf;
        const int positions = gltf.floats("VEC3", {0, 0, 0, 2, 0, 0, 0, 0, 2});
        gltf.json["accessors"][0]["min"] = {0, 0, 0};
        gltf.json["accessors"][0]["max"] = {2, 0, 2};
        gltf.root({{"mesh", gltf.mesh({{"attributes", {{"POSITION", positions}}}})}});
        writeBytes(source, gltf.glb());
        const LoadedScene loaded = loadGltf(source);
        Bake bake = test::randomBake(loaded.scene, 1, false, 3);
        writeBakedFile(target, source, loaded.scene, bake, test::someRecord());
        readTarget();
    }

    void readTarget() {
        bytes = readBytes(target);
        jsonEnd = 20 + nlohmann::json(uint8_t(bytes[12]) | uint8_t(bytes[13]) << 8 | uint8_t(bytes[14]) << 16)
                           .get<size_t>();
    }

    // The file with its JSON changed.
    void rewrite(const std::function<void(nlohmann::json&)>& change) {
        auto json = nlohmann::json::parse(bytes.begin() + 20, bytes.begin() + std::ptrdiff_t(jsonEnd));
        change(json);
        writeBytes(target, test::GltfBuilder::glbOf(
                               json.dump(), {bytes.begin() + std::ptrdiff_t(jsonEnd) + 8, bytes.end()}));
    }
};

TEST_F(BakedDamage, EveryTruncationIsRefused) {
    ASSERT_TRUE(loads(target));
    for (size_t length = bytes.size(); length-- > 0;) {
        ASSERT_EQ(truncate(target.c_str(), off_t(length)), 0);
        ASSERT_FALSE(loads(target)) << length;
    }
}

TEST_F(BakedDamage, FlippedBytesNeverDoHarm) {
    std::mt19937 random(5);
    std::fstream file(target, std::ios::in | std::ios::out | std::ios::binary);
    const auto put = [&](size_t at, char value) {
        file.seekp(std::streamoff(at));
        file.put(value);
        file.flush();
    };
    size_t refused = 0;
    const auto flip = [&](size_t at) {
        put(at, char(bytes[at] ^ (1 << random() % 8)));
        refused += !loads(target);
        put(at, bytes[at]);
    };
    for (size_t at = 0; at < jsonEnd + 8; ++at) flip(at);
    for (int i = 0; i < 3000; ++i) flip(jsonEnd + 8 + random() % (bytes.size() - jsonEnd - 8));
    // zlib's checksum and that of the UVs see nearly all damage past the JSON.
    EXPECT_GT(refused, 2500u);
    EXPECT_TRUE(loads(target));
    EXPECT_LT(peakKilobytes(), 1 << 20);
}

TEST_F(BakedDamage, OtherVersionsAreRefusedByName) {
    for (const int version : {0, 1, 2, 77}) {
        rewrite(
            [&](auto& json) { json["extensions"]["PHAT_photon_accumulation_texture"]["version"] = version; });
        EXPECT_NE(reasonOf(target).find("version " + std::to_string(version)), std::string::npos);
    }
}

TEST_F(BakedDamage, WithoutAUnitOfLengthDistancesAreInMeters) {
    const auto read = [&](const nlohmann::json& unit) {
        rewrite([&](auto& json) {
            json["extensions"]["PHAT_photon_accumulation_texture"].erase("lengthUnit");
            if (!unit.is_null()) json["extensions"]["PHAT_photon_accumulation_texture"]["lengthUnit"] = unit;
        });
        return loads(target) ? readBakedFile(target).atlas.unitMeters : 0;
    };
    EXPECT_EQ(read(nullptr), 1);
    EXPECT_EQ(read(2.5), 2.5f);
    for (const nlohmann::json& wrong :
         {nlohmann::json(0), nlohmann::json(-1), nlohmann::json(1e60), nlohmann::json("m")})
        EXPECT_EQ(read(wrong), 0) << wrong;
}

TEST_F(BakedDamage, SizesThatDoNotAgreeAreRefused) {
    const auto refuses = [&](const std::function<void(nlohmann::json&)>& change) {
        rewrite([&](auto& json) { change(json["extensions"]["PHAT_photon_accumulation_texture"]); });
        return !loads(target);
    };
    EXPECT_FALSE(refuses([](auto&) {}));
    EXPECT_TRUE(refuses([](auto& e) { e["atlas"]["size"] = {65528, 65528}; }));
    EXPECT_TRUE(refuses([](auto& e) { e["atlas"]["size"] = {-8, 8}; }));
    EXPECT_TRUE(refuses([](auto& e) { e["atlas"]["texelSize"] = 0; }));
    EXPECT_TRUE(refuses([](auto& e) { e["atlas"]["chartCount"] = 1e9; }));
    EXPECT_TRUE(refuses([](auto& e) { e["atlas"]["texelChecksum"] = 1; }));
    EXPECT_TRUE(refuses([](auto& e) { e["indirect"]["guideCount"] = 1u << 31; }));
    EXPECT_TRUE(refuses([](auto& e) { e["indirect"]["layers"][0]["radiance"]["byteLength"] = 8; }));
    EXPECT_TRUE(refuses([](auto& e) { e["area"]["layers"].push_back(e["area"]["layers"][0]); }));
    EXPECT_TRUE(refuses([](auto& e) { e["surfaces"].push_back(e["surfaces"][0]); }));
    EXPECT_TRUE(refuses([](auto& e) { e["texCoord"] = 0; }));
    EXPECT_TRUE(refuses([](auto& e) { e.erase("area"); }));
    EXPECT_TRUE(refuses([](auto& e) { e.erase("tiles"); }));
    EXPECT_TRUE(refuses([](auto& e) { e["tiles"].erase("distances"); }));
    EXPECT_TRUE(refuses([](auto& e) { e["bvh"]["nodeCount"] = 1e9; }));
    EXPECT_TRUE(refuses([](auto& e) { e["bvh"]["nodeCount"] = -1; }));
    EXPECT_TRUE(refuses([](auto& e) { e["bvh"]["order"]["byteLength"] = 0; }));
    EXPECT_TRUE(refuses([](auto& e) { e["bvh"]["nodes"] = e["bvh"]["order"]; }));
    EXPECT_TRUE(refuses([](auto& e) { e["bvh"].erase("order"); }));
    EXPECT_FALSE(refuses([](auto& e) { e.erase("bvh"); }));
    EXPECT_TRUE(refuses([](auto& e) { e["tiles"]["places"] = e["tiles"]["distances"]; }));
    EXPECT_TRUE(refuses([](auto& e) { e["indirect"]["layers"][0]["scrambles"] = e["tiles"]["places"]; }));
}

TEST_F(BakedDamage, TreesOfGeometryThatWasMovedAreLeftOut) {
    EXPECT_TRUE(readBakedFile(target).bvh);
    rewrite([](auto& json) { json["nodes"][0]["translation"] = {0, 3, 0}; });
    EXPECT_FALSE(readBakedFile(target).bvh);
    rewrite([](auto& json) { json["extensions"]["PHAT_photon_accumulation_texture"].erase("bvh"); });
    EXPECT_FALSE(readBakedFile(target).bvh);
}

TEST_F(BakedDamage, StoragesThatDoNotFitAreRefused) {
    const LoadedScene loaded = loadGltf(source);
    const Bake bake = test::randomBake(loaded.scene, 1, false, 3);
    const auto reasonAfter = [&](const std::function<void(nlohmann::json&)>& change) {
        rewrite([&](auto& json) { change(json["extensions"]["PHAT_photon_accumulation_texture"]); });
        return reasonOf(target);
    };
    // A packed file that claims to be another.
    EXPECT_NE(reasonAfter([](auto& e) { e["version"] = 4, e["storage"] = "paper"; }), "loads");

    BakeRecord record = test::someRecord();
    record.storage = PhatexelStorage::paper;
    writeBakedFile(target, source, loaded.scene, bake, record);
    readTarget();
    EXPECT_EQ(reasonAfter([](auto&) {}), "loads");
    EXPECT_NE(reasonAfter([](auto& e) { e["version"] = 3; }), "loads");
    EXPECT_NE(reasonAfter([](auto& e) { e.erase("storage"); }), "loads");
    EXPECT_EQ(reasonAfter([](auto& e) { e["storage"] = "half"; }),
              "has PHATexels in an unknown storage, \"half\"");
    const uint64_t bytesThere = 16 * bake.atlas.texelCount();
    for (const uint64_t wrong : {uint64_t(0), bytesThere / 2, bytesThere - 16, bytesThere + 16})
        EXPECT_EQ(reasonAfter([&](auto& e) { e["area"]["layers"][0]["phatexels"]["byteLength"] = wrong; }),
                  "the payload \"phatexels\" has " + std::to_string(wrong) + " bytes where " +
                      std::to_string(bytesThere) + " belong");
    EXPECT_EQ(reasonAfter([](auto& e) {
                  auto& layer = e["indirect"]["layers"][0];
                  layer["phatexels"]["bufferView"] = layer["scrambles"]["bufferView"];
              }).rfind("a payload", 0),
              0u);
}

TEST(PaperStorage, RefusesWhatIsNoRadianceOrNoDirection) {
    const PackedPhatexel16 sound{glm::vec3(1, 2, 3), glm::packHalf2x16({0.5f, -3.0f})};
    const auto read = [](const PackedPhatexel16& texel) { return packedOfPaper({&texel, 1})[0]; };
    EXPECT_EQ(unpackPhatexel(read(sound), 1).radiance, glm::vec3(1, 2, 3));
    for (const float wrong : {-1.0f, float(INFINITY), float(NAN)}) {
        EXPECT_THROW(read({{1, wrong, 1}, sound.anglesHalf}), std::runtime_error);
        EXPECT_THROW(read({sound.radiance, glm::packHalf2x16({wrong, 1.0f})}), std::runtime_error);
    }
    EXPECT_THROW(read({sound.radiance, glm::packHalf2x16({1.6f, 1.0f})}), std::runtime_error);
    EXPECT_THROW(read({sound.radiance, glm::packHalf2x16({1.0f, NAN})}), std::runtime_error);
    EXPECT_THROW(read({sound.radiance, glm::packHalf2x16({1.0f, 3.2f})}), std::runtime_error);
    EXPECT_FALSE(unpackPhatexel(read({{NAN, -1, 1}, ~0u}), 1).valid);
}

TEST_F(BakedDamage, TexelSizesThatCannotBeAreRefused) {
    const LoadedScene loaded = loadGltf(source);
    const Bake sound = test::randomBake(loaded.scene, 1, false, 3);
    ASSERT_NE(sound.atlas.charts[0].otherSide, kNoChart);
    const float size = sound.atlas.charts[0].texelSizeMeters;
    for (const float wrong : {0.0f, -size, 1.5f * size, INFINITY, NAN}) {
        Bake bake = sound;
        for (Chart& chart : bake.atlas.charts) chart.texelSizeMeters = wrong;
        writeBakedFile(target, source, loaded.scene, bake, test::someRecord());
        EXPECT_NE(reasonOf(target).find("texel size"), std::string::npos) << wrong << reasonOf(target);
    }
    Bake bake = sound;
    bake.atlas.charts[0].texelSizeMeters = 0.5f * size;
    writeBakedFile(target, source, loaded.scene, bake, test::someRecord());
    EXPECT_NE(reasonOf(target).find("other side"), std::string::npos) << reasonOf(target);
}

// 100 MB of zeros are 100 kB of zlib stream: what they claim must not be allocated for them.
TEST(Payload, HoldsExactlyWhatItsSizeSays) {
    const std::vector<uint8_t> zeros(100 << 20);
    const std::vector<uint8_t> stream = encodePayload(zeros);
    EXPECT_LT(stream.size(), zeros.size() / 900);
    EXPECT_EQ(decodePayload(stream, zeros.size()), zeros);
    EXPECT_THROW(decodePayload(stream, zeros.size() - 1), std::runtime_error);
    EXPECT_THROW(decodePayload(stream, zeros.size() + 1), std::runtime_error);
    EXPECT_THROW(decodePayload(stream, ~size_t(0)), std::runtime_error);
    EXPECT_THROW(decodePayload({}, 4), std::runtime_error);
    auto longer = stream;
    longer.push_back(0);
    EXPECT_THROW(decodePayload(longer, zeros.size()), std::runtime_error);
    EXPECT_TRUE(decodePayload(encodePayload({}), 0).empty());
}

}  // namespace
}  // namespace phat
