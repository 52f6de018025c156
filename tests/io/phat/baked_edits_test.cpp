#include "io/phat/baked_edits.h"

#include <gtest/gtest.h>

#include <random>

#include "io/base/file_error.h"
#include "io/gltf/gltf_source.h"
#include "io/gltf/material_edit.h"
#include "io/phat/baked_scene.h"

namespace phat::test {
namespace {

struct BakedEdits : testing::Test {
    BakedEdits() {
        writeBytes(source, hardScene().glb());
        const LoadedScene loaded = loadGltf(source);
        writeBakedFile(baked, source, loaded.scene, randomBake(loaded.scene, 1, false, 1), someRecord());
        before = readBakedFile(baked);
    }
    TemporaryFolder folder;
    const std::string source = folder.file("hard.glb"), baked = folder.file("hard.phat.glb");
    BakedScene before;
};

TEST_F(BakedEdits, ComeBackWhenTheFileIsRead) {
    SceneEdits edited = noEdits(before.loaded.scene);
    for (const char* edit :
         {"paint.roughness=0.55", "paint.metallic=0.25", "paint.baseColor=.1,.2,.3", "paint.ior=1.7",
          "paint.specular=0.5", "paint.specularColor=.9,.8,.7", "paint.clearcoat=1",
          "paint.clearcoatRoughness=.125", "paint.transmission=.75", "paint.thickness=.5",
          "paint.attenuationDistance=2", "paint.attenuationColor=.25,.5,1", "paint.emission=2,4,8"})
        editMaterial(edit, edited.materials);
    edited.lights.at(0).intensity = {1, 2, 3};
    writeEdits(baked, baked, noEdits(before.loaded.scene), edited);

    const BakedScene after = readBakedFile(baked);
    const auto differences = materialEdits(after.loaded.scene.materials, edited.materials);
    EXPECT_TRUE(differences.empty()) << differences.front();
    for (int c = 0; c < 3; ++c)
        EXPECT_FLOAT_EQ(after.loaded.scene.lights.at(0).intensity[c], edited.lights[0].intensity[c]);
    EXPECT_EQ(after.phatexture.indirect[0].texels.size(), before.phatexture.indirect[0].texels.size());
    EXPECT_EQ(after.phatexture.indirectIrradiance, before.phatexture.indirectIrradiance);
    EXPECT_EQ(openGltf(baked).json["extensions"]["KHR_lights_punctual"]["lights"].size(), 1u);
}

TEST_F(BakedEdits, ChangeNothingWhereThereAreNone) {
    const auto bytes = readBytes(baked);
    writeEdits(baked, baked, noEdits(before.loaded.scene), noEdits(before.loaded.scene));
    EXPECT_EQ(readBytes(baked), bytes);
}

TEST_F(BakedEdits, AreTakenBackFromTheFile) {
    const auto bytes = readBytes(baked);
    SceneEdits edited = noEdits(before.loaded.scene);
    editMaterial("paint.roughness=0.55", edited.materials);
    writeEdits(baked, baked, noEdits(before.loaded.scene), edited);
    EXPECT_NE(readBytes(baked), bytes);
    writeEdits(baked, baked, edited, noEdits(before.loaded.scene));
    const auto left =
        materialEdits(readBakedFile(baked).loaded.scene.materials, before.loaded.scene.materials);
    EXPECT_TRUE(left.empty()) << left.front();
}

TEST_F(BakedEdits, TurnTheSkyByItsOwnTexels) {
    Scene scene = loadGltf(source).scene;
    Environment sky{Image(8, 4)};
    std::mt19937 random(1);
    for (glm::vec3& pixel : sky.radiance.pixels) pixel = glm::vec3(float(random() % 512), 1, 2);
    scene.environment = sky;
    writeBakedFile(baked, source, scene, randomBake(scene, 1, false, 1), someRecord());
    const auto bytes = readBytes(baked);
    SceneEdits edited = noEdits(scene);
    edited.environmentColumns = 3;
    writeEdits(baked, baked, noEdits(scene), edited);
    const BakedScene after = readBakedFile(baked);
    ASSERT_TRUE(after.loaded.scene.environment);
    for (int y = 0; y < 4; ++y)
        for (int x = 0; x < 8; ++x)
            EXPECT_EQ(after.loaded.scene.environment->radiance.at((x + 3) % 8, y),
                      scene.environment->radiance.at(x, y));
    EXPECT_EQ(after.phatexture.indirectIrradiance.size(), before.phatexture.indirectIrradiance.size());
    // Back, and nothing has grown: the old sky's bytes are gone.
    writeEdits(baked, baked, edited, noEdits(scene));
    EXPECT_EQ(readBakedFile(baked).loaded.scene.environment->radiance.pixels,
              scene.environment->radiance.pixels);
    EXPECT_EQ(readBytes(baked).size(), bytes.size());
}

TEST_F(BakedEdits, NameTheFileThatCannotBeRead) {
    const std::string missing = folder.file("missing.phat.glb");
    try {
        writeEdits(missing, missing, noEdits(before.loaded.scene), noEdits(before.loaded.scene));
        FAIL();
    } catch (const FileError& error) {
        EXPECT_EQ(error.path, missing);
    }
}

}  // namespace
}  // namespace phat::test
