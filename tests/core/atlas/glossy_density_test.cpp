#include "core/atlas/glossy_density.h"

#include <gtest/gtest.h>

#include <numeric>

#include "core/atlas/atlas_checks.h"
#include "support/scene_builder.h"

namespace phat {
namespace {

Material metal(float roughness) {
    Material material;
    material.roughness = roughness;
    return material;
}

Material dielectric(float roughness) {
    Material material = metal(roughness);
    material.metallic = 0;
    return material;
}

float densityOf(const Material& material, float most = 8) {
    Scene scene;
    test::addFloor(scene, material, 1);
    return glossyDensities(scene, most)[0];
}

// A white metal's weight is (.6 / roughness)^4, its density the cube root.
TEST(GlossyDensity, FollowsTheLobeOfAMetal) {
    for (const float roughness : {0.25f, 0.3f, 0.45f})
        EXPECT_NEAR(densityOf(metal(roughness)), std::pow(0.6f / roughness, 4.0f / 3), 1e-4f);
    for (const float roughness : {0.6f, 0.8f, 1.0f}) EXPECT_EQ(densityOf(metal(roughness)), 1);
    EXPECT_EQ(densityOf(metal(0)), densityOf(metal(0.2f)));
    EXPECT_EQ(densityOf(metal(0.25f), 2), 2);
    EXPECT_EQ(densityOf(metal(0.25f), 1), 1);
    Material dark = metal(0.3f);
    dark.baseColor = glm::vec4(glm::vec3(0.5f), 1);
    EXPECT_NEAR(densityOf(dark), std::cbrt(0.5f * 16), 1e-4f);
}

TEST(GlossyDensity, DielectricsNeedItOnlyWherePolished) {
    for (const float roughness : {0.3f, 0.5f, 1.0f}) EXPECT_EQ(densityOf(dielectric(roughness)), 1);
    EXPECT_NEAR(densityOf(dielectric(0.1f)), std::cbrt(0.04f * 81), 1e-3f);
    Material unlit = metal(0.2f);
    unlit.unlit = true;
    EXPECT_EQ(densityOf(unlit), 1);
}

TEST(GlossyDensity, CountsTheCoat) {
    Material coated = dielectric(1);
    coated.clearcoat = 1;
    coated.clearcoatRoughness = 0.1f;
    // .04 / .36^2 ... of the rough base: its alpha is 1.
    EXPECT_NEAR(densityOf(coated), std::cbrt(0.04f * (81 + 0.6f * 0.6f * 0.6f * 0.6f)), 1e-3f);
    coated.clearcoatRoughness = 0.5f;
    EXPECT_EQ(densityOf(coated), 1);
}

// Left half of the texture rough, right half of roughness .3: half of the places weigh 16, half .13.
TEST(GlossyDensity, IsTheMeanOfATexture) {
    Scene scene;
    Material material = metal(1);
    material.metallicRoughnessTexture = {.image = 0, .nearest = true};
    scene.images.push_back(TextureImage{"halves", 2, 1, {{0, 255, 255, 255}, {0, 77, 255, 255}}});
    test::addFloor(scene, material, 3);
    const float sharp = std::pow(0.6f / (77.0f / 255), 4.0f), rough = std::pow(0.6f, 4.0f);
    const float expected = std::cbrt(0.5f * (sharp + rough));
    // 64 places at random within their shares: the share of sharp ones has a standard deviation below 1/16,
    // and the cube root makes a third of that.
    EXPECT_NEAR(glossyDensities(scene, 8)[0], expected, 3.0f / 16 / 3 * expected);
    EXPECT_EQ(glossyDensities(scene, 8), glossyDensities(scene, 8));
}

double meanSquare(const std::vector<double>& area, const std::vector<double>& density) {
    double sum = 0, total = 0;
    for (size_t i = 0; i < area.size(); ++i) {
        sum += area[i] * density[i] * density[i];
        total += area[i];
    }
    return sum / total;
}

TEST(GlossyDensity, CostsTheOthersAQuarterAtMost) {
    std::vector<double> area = {97, 3}, density = {1, 3};
    keepBudget(area, density);
    EXPECT_EQ(density, (std::vector<double>{1, 3}));  // .97 + .03 * 9 < 1.25^2
    area = {40, 30, 30}, density = {1, 2, 3};
    keepBudget(area, density);
    EXPECT_NEAR(meanSquare(area, density), 1.25 * 1.25, 1e-9);
    EXPECT_EQ(density[0], 1);
    EXPECT_NEAR(density[2] - 1, 2 * (density[1] - 1), 1e-9);
    density = {3, 3, 3};
    keepBudget(area, density);
    EXPECT_EQ(density, (std::vector<double>{1, 1, 1}));
    keepBudget({}, {});
}

// A rough floor with a little mirror-like plate above it; the plate is seen from both sides.
Scene floorAndPlate(float plate, const Material& material) {
    Scene scene;
    test::addFloor(scene, dielectric(0.9f), 3);
    test::addFloor(scene, material, plate, 1);
    return scene;
}

Atlas atlasOf(const Scene& scene, const AtlasSettings& settings) {
    SilentProgress progress;
    const Atlas atlas = buildAtlas(scene, {Sides::front, Sides::both}, settings, progress);
    expectSoundAtlas(scene, atlas, settings);
    return atlas;
}

double texelsPerSquareMeter(const Scene& scene, const Atlas& atlas, uint32_t triangle) {
    return texelAreaOf(atlas, triangle) / areaOf(scene, triangle);
}

TEST(GlossyAtlas, PlateHasNineTimesTheTexelsOnItsArea) {
    const Scene scene = floorAndPlate(0.5f, metal(0.22f));
    AtlasSettings settings;
    settings.texelBudget = 1 << 18;
    const Atlas atlas = atlasOf(scene, settings);
    // Either may be kFillFreedom off along a length.
    EXPECT_NEAR(texelsPerSquareMeter(scene, atlas, 2) / texelsPerSquareMeter(scene, atlas, 0), 9,
                9 * (std::pow(kFillFreedom, 4) - 1));
    AtlasSettings exact = settings;
    exact.texelSizeMeters = atlas.texelSizeMeters;
    const Atlas ofThatSize = atlasOf(scene, exact);
    EXPECT_NEAR(texelsPerSquareMeter(scene, ofThatSize, 2) / texelsPerSquareMeter(scene, ofThatSize, 0), 9,
                0.01);
    for (uint32_t t = 0; t < 4; ++t) {
        const glm::dvec2 sigma = singularValues(scene, atlas, t);
        EXPECT_NEAR(sigma.x, 1, 1e-3);
        EXPECT_NEAR(sigma.y, 1, 1e-3);
    }
    ASSERT_EQ(atlas.charts.size(), 3u);
    EXPECT_EQ(atlas.charts[1].texelSizeMeters, atlas.charts[2].texelSizeMeters);
    EXPECT_NEAR(double(atlas.texelCount()), double(settings.texelBudget), 0.1 * double(settings.texelBudget));
    // Gutters too lie on a grid of the plate's own texels.
    const TexelPoints points = buildTexelPoints(scene, atlas);
    for (uint32_t y = 0; y < atlas.sizeTexels.y; ++y) {
        for (uint32_t x = 0; x + 1 < atlas.sizeTexels.x; ++x) {
            const size_t i = size_t(y) * atlas.sizeTexels.x + x;
            if (!points.valid(i) || !points.valid(i + 1) ||
                atlas.chartAt({x, y}) != atlas.chartAt({x + 1, y}))
                continue;
            const float size = atlas.charts[atlas.chartAt({x, y})].texelSizeMeters;
            ASSERT_NEAR(glm::distance(points.position[i], points.position[i + 1]), size, 1e-3f * size);
        }
    }
}

TEST(GlossyAtlas, DensityOneIsUniform) {
    AtlasSettings settings;
    settings.texelBudget = 1 << 16;
    settings.glossyDensity = 1;
    const Scene glossy = floorAndPlate(1, metal(0.22f)), rough = floorAndPlate(1, metal(0.9f));
    const Atlas atlas = atlasOf(glossy, settings);
    EXPECT_GE(atlas.finestTexelSizeMeters() * square(float(kFillFreedom)), 0.9999f * atlas.texelSizeMeters);
    settings.glossyDensity = 3;
    EXPECT_EQ(atlasOf(rough, settings).triangleTexels, atlas.triangleTexels);
}

// The plate's two sides are three quarters of all: three times finer texels would take nearly all of them.
TEST(GlossyAtlas, LargePlatesDoNotStarveTheRest) {
    const Scene scene = floorAndPlate(3.6f, metal(0.22f));
    AtlasSettings settings;
    settings.texelBudget = 1 << 18;
    const Atlas atlas = atlasOf(scene, settings);
    settings.glossyDensity = 1;
    const Atlas uniform = atlasOf(scene, settings);
    // Whole tiles of three charts.
    EXPECT_NEAR(atlas.texelSizeMeters / uniform.texelSizeMeters, 1.25f, 0.04f);
    EXPECT_LT(atlas.finestTexelSizeMeters(), uniform.texelSizeMeters);
}

// No budget to share: the rough surfaces' texels are what was asked for.
TEST(GlossyAtlas, GivenTexelSizeIsThatOfRoughSurfaces) {
    const Scene scene = floorAndPlate(3.6f, metal(0.22f));
    AtlasSettings settings;
    settings.texelSizeMeters = 0.02f;
    settings.glossyDensity = 2;
    const Atlas atlas = atlasOf(scene, settings);
    EXPECT_EQ(atlas.charts[0].texelSizeMeters, 0.02f);
    EXPECT_EQ(atlas.charts[1].texelSizeMeters, 0.01f);
}

TEST(GlossyAtlas, RefusesImpossibleDensities) {
    const Scene scene = floorAndPlate(1, metal(0.22f));
    SilentProgress progress;
    for (const float density : {0.99f, 0.0f, -3.0f, 8.01f, INFINITY, NAN}) {
        AtlasSettings settings;
        settings.glossyDensity = density;
        EXPECT_THROW(buildAtlas(scene, {}, settings, progress), std::invalid_argument) << density;
    }
}

}  // namespace
}  // namespace phat
