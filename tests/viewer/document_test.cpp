#include "viewer/document.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "core/bake/bake.h"
#include "io/phat/bake_record.h"
#include "support/temporary_folder.h"

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

}  // namespace
}  // namespace phat
