// Lamps with photometric files in baked files.

#include <gtest/gtest.h>

#include "io/gltf/gltf_light_profiles.h"
#include "io/gltf/gltf_source.h"
#include "io/phat/baked_edits.h"
#include "io/phat/baked_scene.h"
#include "support/ies_writer.h"

namespace phat::test {
namespace {

std::string washerText() {
    IesWriter file;
    file.vertical = degreesFrom(0, 90, 5);
    file.horizontal = degreesFrom(0, 180, 30);
    file.candela = [](double v, double h) { return 5 + v + h; };
    return file.text();
}

// One lamp by a file beside the scene, one by a bufferView, and the scene's own point light.
struct BakedPhotometry : testing::Test {
    BakedPhotometry() {
        GltfBuilder gltf = hardScene();
        const std::string text = washerText();
        const std::vector<char> bytes(text.begin(), text.end());
        writeBytes(folder.file("washer.ies"), bytes);
        gltf.json["extensionsUsed"].push_back("EXT_lights_ies");
        gltf.json["extensions"]["EXT_lights_ies"]["lights"] = {
            {{"uri", "washer.ies"}},
            {{"bufferView", gltf.view(bytes)}, {"mimeType", "application/x-ies-lm-63"}}};
        for (const int profile : {0, 1})
            gltf.root({{"name", "lamp"}, {"extensions", {{"EXT_lights_ies", {{"light", profile}}}}}});
        writeBytes(source, gltf.glb());
        scene = loadGltf(source).scene;
        writeBakedFile(baked, source, scene, randomBake(scene, 1, false, 1), someRecord());
    }
    TemporaryFolder folder;
    const std::string source = folder.file("hard.glb"), baked = folder.file("hard.phat.glb");
    Scene scene;
};

TEST_F(BakedPhotometry, ComesBackWithoutTheFileBesideTheScene) {
    std::filesystem::remove(folder.file("washer.ies"));
    const BakedScene after = readBakedFile(baked);
    ASSERT_EQ(after.loaded.scene.lights.size(), 3u);
    int photometric = 0;
    for (size_t i = 0; i < 3; ++i) {
        const PunctualLight &was = scene.lights[i], &is = after.loaded.scene.lights[i];
        EXPECT_EQ(is.intensity, was.intensity);
        ASSERT_EQ(bool(is.photometry), bool(was.photometry));
        if (!is.photometry) continue;
        ++photometric;
        EXPECT_EQ(is.photometry->web().relative, was.photometry->web().relative);
        EXPECT_EQ(is.horizontalZero, was.horizontalZero);
    }
    EXPECT_EQ(photometric, 2);
}

TEST_F(BakedPhotometry, TablesForTheBrowserAreThoseOfTheFiles) {
    const nlohmann::json gltf = openGltf(baked).json;
    const auto& tables = gltf["extensions"]["PHAT_photon_accumulation_texture"]["photometries"];
    ASSERT_EQ(tables.size(), 2u);
    for (const size_t i : {0u, 1u}) {
        EXPECT_EQ(tables[i]["light"], i);
        EXPECT_EQ(tables[i]["steps"][0], 180);  // ends in the light, at 90 degrees
        EXPECT_EQ(tables[i]["steps"][1], 12);
        EXPECT_FLOAT_EQ(tables[i]["peakCandela"].get<float>(), 275);
        EXPECT_EQ(tables[i]["relative"]["byteLength"], 181 * 12 * 4);
        EXPECT_FALSE(gltf["extensions"]["EXT_lights_ies"]["lights"][i].contains("uri"));
    }
}

TEST_F(BakedPhotometry, EditsOfIntensityAndColourComeBack) {
    const BakedScene before = readBakedFile(baked);
    SceneEdits edited = noEdits(before.loaded.scene);
    for (PunctualLight& light : edited.lights)
        if (light.photometry) light.intensity = {10, 20, 5};
    writeEdits(baked, baked, noEdits(before.loaded.scene), edited);
    const BakedScene after = readBakedFile(baked);
    for (size_t i = 0; i < 3; ++i)
        for (int c = 0; c < 3; ++c)
            EXPECT_FLOAT_EQ(after.loaded.scene.lights[i].intensity[c], edited.lights[i].intensity[c]);
}

}  // namespace
}  // namespace phat::test
