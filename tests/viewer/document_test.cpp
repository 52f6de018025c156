#include "viewer/document.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "core/bake/bake.h"
#include "io/phat/bake_record.h"
#include "support/run_program.h"
#include "support/temporary_folder.h"
#include "support/variant_scene.h"

namespace phat {
namespace {

TEST(Document, SavesTheSettingsThatItsBakeWasMadeWith) {
    const TemporaryFolder folder;
    const std::string path = folder.file("room.glb");
    std::filesystem::copy_file(PHAT_SOURCE_DIR "/scenes/furnace.glb", path);
    Document document(path, SceneLighting());
    ASSERT_FALSE(document.hasBake);
    BakeSettings settings;
    settings.atlas.texelBudget = 2000;
    settings.photons.count = 1000;
    settings.layers = 2;
    settings.seed = settings.photons.seed = 5;
    SilentProgress progress;
    document.takeBake(bake(document.scene(), settings, progress), settings);
    ASSERT_TRUE(document.hasBake);

    const BakeRecord saved = readBakedFile(document.save()).record;
    const BakeRecord expected = recordOf(settings, path, "");
    EXPECT_EQ(saved.settings, expected.settings);
    EXPECT_EQ(saved.source, "room.glb");
    EXPECT_EQ(saved.seed, 5u);
    EXPECT_EQ(saved.generator, expected.generator);
}

TEST(Document, ShowsAndSavesTheVariantThatItIsOpenedBy) {
    const TemporaryFolder folder;
    const std::string text = sceneWithVariants(), path = folder.file("room.gltf");
    writeBytes(path, {text.begin(), text.end()});
    const auto shownEmission = [](const Scene& scene) { return scene.materialOf(0).emission.x; };
    EXPECT_EQ(shownEmission(Document(path, SceneLighting()).shown()), 1);
    EXPECT_THROW(Document(path, SceneLighting(), "red"), FileError);
    Document document(path, SceneLighting(), "dark");
    EXPECT_EQ(shownEmission(document.shown()), 0.1f);
    BakeSettings settings;
    settings.atlas.texelBudget = 2000;
    settings.photons.count = 1000;
    SilentProgress progress;
    document.takeBake(bake(document.scene(), settings, progress), settings);
    const BakedScene saved = readBakedFile(document.save());
    EXPECT_EQ(shownEmission(saved.loaded.scene), 0.1f);
    EXPECT_NE(saved.record.settings.find(R"("variant":"dark")"), std::string::npos) << saved.record.settings;
}

}  // namespace
}  // namespace phat
