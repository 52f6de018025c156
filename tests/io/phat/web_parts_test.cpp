// A baked file in parts for the web.

#include "io/phat/web_parts.h"

#include <gtest/gtest.h>

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
    replaceFile(folder.file("room.glb"), parts.room);
    size_t laterBytes = 0;
    std::vector<std::string> names;
    for (const WebPart& part : parts.later) {
        replaceFile(folder.file(part.uri), part.bytes);
        laterBytes += part.bytes.size();
        names.push_back(part.uri);
    }
    EXPECT_EQ(names,
              (std::vector<std::string>{"room.lamps.bin", "room.reflections.bin", "room.reflections-2.bin"}));
    const Phatexture a = readBakedFile(whole).phatexture,
                     b = readBakedFile(folder.file("room.glb")).phatexture;
    ASSERT_EQ(b.indirect.size(), 2u);
    for (size_t layer = 0; layer < 2; ++layer)
        for (size_t i = 0; i < a.indirect[layer].texels.size(); ++i) {
            ASSERT_EQ(a.indirect[layer].texels[i].radiance, b.indirect[layer].texels[i].radiance);
            ASSERT_EQ(a.indirect[layer].texels[i].directionDistance,
                      b.indirect[layer].texels[i].directionDistance);
        }
    EXPECT_EQ(a.indirectIrradiance, b.indirectIrradiance);
    // Random PHATexels hardly compress: most bytes wait.
    EXPECT_GT(laterBytes, 2 * parts.room.size());

    // Without the last part, the others can still be read.
    std::filesystem::remove(folder.file("room.reflections-2.bin"));
    EXPECT_THROW(readBakedFile(folder.file("room.glb")), FileError);
    const auto json = openGltf(folder.file("room.glb")).json;
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

TEST(WebParts, NeedABakedFile) {
    const TemporaryFolder folder;
    const std::string source = folder.file("hard.glb");
    writeBytes(source, test::hardScene().glb());
    GltfSource opened = openGltf(source);
    EXPECT_THROW(splitForWeb(opened, "room"), FileError);
}

}  // namespace
}  // namespace phat
