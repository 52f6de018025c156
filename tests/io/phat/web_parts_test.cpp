// A baked file in parts for the web.

#include "io/phat/web_parts.h"

#include <gtest/gtest.h>

#include <regex>
#include <set>

#include "io/base/atomic_file.h"
#include "io/base/file_error.h"
#include "io/gltf/gltf_source.h"
#include "io/phat/baked_scene.h"

namespace phat {
namespace {

TEST(WebParts, AreTheSameBakeTogether) {
    const TemporaryFolder folder;
    const std::string source = folder.file("hard.glb"), whole = folder.file("whole.phat.glb");
    writeBytes(source, test::hardScene().glb());
    const LoadedScene loaded = loadGltf(source);
    writeBakedFile(whole, source, loaded.scene, test::randomBake(loaded.scene, 2, false, 9),
                   test::someRecord());

    GltfSource opened = openGltf(whole);
    const WebParts parts = splitForWeb(opened, "room");
    const std::string room = folder.file(parts.room.uri);
    replaceFile(room, parts.room.bytes);
    size_t laterBytes = 0;
    std::vector<std::string> names;
    for (const WebPart& part : parts.later) {
        replaceFile(folder.file(part.uri), part.bytes);
        laterBytes += part.bytes.size();
        names.push_back(std::regex_replace(part.uri, std::regex("[.][0-9a-f]{8}[.]"), ".HASH."));
    }
    EXPECT_EQ(names, (std::vector<std::string>{"room.lamps.HASH.bin", "room.reflections.HASH.bin",
                                               "room.reflections-2.HASH.bin"}));
    const Phatexture a = readBakedFile(whole).phatexture, b = readBakedFile(room).phatexture;
    ASSERT_EQ(b.indirect.size(), 2u);
    for (size_t layer = 0; layer < 2; ++layer)
        for (size_t i = 0; i < a.indirect[layer].texels.size(); ++i) {
            ASSERT_EQ(a.indirect[layer].texels[i].radiance, b.indirect[layer].texels[i].radiance);
            ASSERT_EQ(a.indirect[layer].texels[i].directionDistance,
                      b.indirect[layer].texels[i].directionDistance);
        }
    EXPECT_EQ(a.indirectIrradiance, b.indirectIrradiance);
    // Random PHATexels hardly compress: most bytes wait.
    EXPECT_GT(laterBytes, 2 * parts.room.bytes.size());

    // Without the last part, the others can still be read.
    std::filesystem::remove(folder.file(parts.later.back().uri));
    EXPECT_THROW(readBakedFile(room), FileError);
    const auto json = openGltf(room).json;
    const auto& extension = json["extensions"]["PHAT_photon_accumulation_texture"];
    const auto bufferOf = [&](const nlohmann::json& payload) {
        return json["bufferViews"][payload["bufferView"].get<size_t>()]["buffer"];
    };
    EXPECT_EQ(bufferOf(extension["indirect"]["irradiance"]), 0);
    EXPECT_EQ(bufferOf(extension["tiles"]["places"]), 0);
    EXPECT_EQ(bufferOf(extension["area"]["layers"][0]["direction"]), 1);
    EXPECT_EQ(bufferOf(extension["bvh"]["nodes"]), 1);
    EXPECT_EQ(bufferOf(extension["bvh"]["order"]), 1);
    EXPECT_EQ(bufferOf(extension["indirect"]["guides"]), 2);
    EXPECT_EQ(bufferOf(extension["indirect"]["layers"][0]["radiance"]), 2);
    EXPECT_EQ(bufferOf(extension["indirect"]["layers"][1]["radiance"]), 3);
}

// A cache that holds the parts of one bake must not meet the room of another with them.
TEST(WebParts, HaveOtherNamesWhereTheirBytesDiffer) {
    const TemporaryFolder folder;
    const std::string source = folder.file("hard.glb"), baked = folder.file("baked.phat.glb");
    writeBytes(source, test::hardScene().glb());
    const LoadedScene loaded = loadGltf(source);
    const auto namesOf = [&](uint32_t seed) {
        writeBakedFile(baked, source, loaded.scene, test::randomBake(loaded.scene, 1, false, seed),
                       test::someRecord());
        GltfSource opened = openGltf(baked);
        const WebParts parts = splitForWeb(opened, "room");
        std::set<std::string> names{parts.room.uri};
        for (const WebPart& part : parts.later) names.insert(part.uri);
        return names;
    };
    const std::set<std::string> names = namesOf(9), others = namesOf(10);
    EXPECT_EQ(names, namesOf(9));
    for (const std::string& name : others) EXPECT_FALSE(names.contains(name)) << name;
}

TEST(WebParts, NeedABakedFile) {
    const TemporaryFolder folder;
    const std::string source = folder.file("hard.glb");
    writeBytes(source, test::hardScene().glb());
    GltfSource opened = openGltf(source);
    EXPECT_THROW(splitForWeb(opened, "room"), FileError);
}

}  // namespace
}  // namespace phat
