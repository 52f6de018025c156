// The atlas on whole scenes: figures that a user of the default settings gets.

#include <gtest/gtest.h>

#include <filesystem>

#include "core/atlas/atlas_checks.h"
#include "io/gltf/gltf_loader.h"

namespace phat {
namespace {

std::vector<std::filesystem::path> scenePaths() {
    std::vector<std::filesystem::path> paths;
    for (const char* folder : {PHAT_SOURCE_DIR "/scenes", PHAT_SOURCE_DIR "/../shared/scenes"}) {
        if (!std::filesystem::is_directory(folder)) continue;
        for (const auto& entry : std::filesystem::directory_iterator(folder))
            if (entry.path().extension() == ".glb") paths.push_back(entry.path());
    }
    std::sort(paths.begin(), paths.end());
    return paths;
}

TEST(AtlasScenes, AreSoundDenseAndNearIsometric) {
    const auto paths = scenePaths();
    ASSERT_FALSE(paths.empty());
    for (const std::filesystem::path& path : paths) {
        SCOPED_TRACE(path.filename().string());
        const Scene scene = loadGltf(path.string()).scene;
        const AtlasSettings settings;
        SilentProgress progress;
        AtlasStats stats;
        const Atlas atlas = buildAtlas(scene, {}, settings, progress, &stats);
        expectSoundAtlas(scene, atlas, settings);
        EXPECT_GE(fractionWithinStretch(scene, atlas, 1.5), 0.95);
        EXPECT_GT(double(atlas.texelCount()), 0.9 * double(settings.texelBudget));
        EXPECT_LT(double(atlas.texelCount()), 1.1 * double(settings.texelBudget));
        EXPECT_GE(stats.coverage, 0.70f);
        double texels = 0;
        for (uint32_t t = 0; t < scene.triangles.size(); ++t)
            if (atlas.triangleChart[t] != kNoChart)
                texels += areaOf(scene, t) / square(atlas.charts[atlas.triangleChart[t]].texelSizeMeters);
        EXPECT_NEAR(stats.coverage * double(atlas.texelCount()), texels, 0.02 * texels);

        AtlasSettings uniform;
        uniform.glossyDensity = 1;
        AtlasStats uniformStats;
        const Atlas reference = buildAtlas(scene, {}, uniform, progress, &uniformStats);
        EXPECT_GE(uniformStats.coverage, 0.70f);
        EXPECT_GE(1.0001 * kFillFreedom * kFillFreedom * double(reference.finestTexelSizeMeters()),
                  double(reference.texelSizeMeters));
        // Gutters, and what the packer leaves open, differ between the two.
        EXPECT_LT(atlas.texelSizeMeters, 1.05f * 1.25f * reference.texelSizeMeters);
    }
}

}  // namespace
}  // namespace phat
