// Textures averaged over footprints.

#include "core/scene/footprint.h"

#include <gtest/gtest.h>

#include <optional>

#include "support/scene_builder.h"

namespace phat::test {
namespace {

constexpr int kSide = 64, kPeriod = 8;  // of an image with a dark column in every kPeriod, texels

/// A square of a metre with that image; its u runs along x, its v along z.
Scene stripedFloor(glm::u8vec4 dark, glm::u8vec4 bright, int side = kSide) {
    Scene scene;
    TextureImage image;
    image.width = image.height = side;
    for (int i = 0; i < side * side; ++i) image.texels.push_back(i % side % kPeriod == 0 ? dark : bright);
    scene.images.push_back(image);
    Material material = lambert(1);
    material.baseColorTexture.image = 0;
    addQuad(scene, material, {0, 0, 0}, {1, 0, 0}, {0, 0, -1});
    return scene;
}

struct Striped {
    Scene scene;
    TextureLevels levels{scene};

    // Of the floor at 10 places of an eighth of the image, as their least and greatest.
    glm::vec2 range(glm::vec3 alongX, glm::vec3 alongZ) const {
        glm::vec2 range(1e30f, -1e30f);
        for (int i = 0; i < 10; ++i) {
            const Hit hit{1, 0, {0.4f + 0.125f * float(i) / 10, 0.1f}, false};
            const SurfacePoint at = surfaceAt(scene, hit, {0, -1, 0}, Footprint{levels, {alongX, alongZ}});
            range = {std::min(range.x, at.brdf.diffuseColor.r), std::max(range.y, at.brdf.diffuseColor.r)};
        }
        return range;
    }
};

constexpr glm::u8vec4 kBlack(0, 0, 0, 255), kWhite(255);
constexpr float kTexel = 1.0f / kSide;

TEST(Footprint, LinesNarrowerThanItAreMeans) {
    const Striped striped{stripedFloor(kBlack, kWhite)};
    const float mean = 1 - 1.0f / kPeriod;
    // A period and more, with levels that are means of whole periods, and 8 bits of sRGB.
    for (const float texels : {16.0f, 40.0f}) {
        const glm::vec2 range = striped.range({texels * kTexel, 0, 0}, {0, 0, texels * kTexel});
        EXPECT_NEAR(range.x, mean, 0.01f) << texels;
        EXPECT_NEAR(range.y, mean, 0.01f) << texels;
    }
}

TEST(Footprint, NoneIsSmallerThanATexel) {
    const Striped striped{stripedFloor(kBlack, kWhite)};
    for (const float texels : {0.0f, 0.5f, 1.0f})
        EXPECT_EQ(striped.range({texels * kTexel, 0, 0}, {0, 0, texels * kTexel}),
                  striped.range(glm::vec3(0), glm::vec3(0)));
    EXPECT_LT(striped.range(glm::vec3(0), glm::vec3(0)).x, 0.4f);  // by the nearest of its places to a line
}

// As a floor is seen at a grazing angle, along its lines.
TEST(Footprint, LongOnesBlurAlongThemselvesAlone) {
    const Striped striped{stripedFloor(kBlack, kWhite)};
    for (const bool turned : {false, true}) {  // which side is the longer one
        const glm::vec3 narrow(1.5f * kTexel, 0, 0), far(0, 0, 12 * kTexel);
        const glm::vec2 range = turned ? striped.range(far, narrow) : striped.range(narrow, far);
        EXPECT_LT(range.x, 0.6f);
        EXPECT_GT(range.y, 0.95f);
    }
    const glm::vec2 across = striped.range({8 * kTexel, 0, 0}, {0, 0, kTexel});
    EXPECT_NEAR(across.x, 1 - 1.0f / kPeriod, 0.02f);
    EXPECT_NEAR(across.y, 1 - 1.0f / kPeriod, 0.02f);
}

// Of an image whose side is no power of two every texel counts.
TEST(Footprint, LevelsAreMeansOfLinearValues) {
    for (const int side : {64, 56}) {
        const Scene scene = stripedFloor({20, 20, 20, 0}, {200, 200, 200, 255}, side);
        const TextureLevels levels(scene);
        const TextureImage& last = levels.at(scene, 0, true, 99);
        ASSERT_EQ(last.texels.size(), 1u);
        const float dark = 0.00700f, bright = 0.57758f;  // of IEC 61966-2-1
        const float mean = (dark + (kPeriod - 1) * bright) / kPeriod;
        const float code = 255 * (1.055f * std::pow(mean, 1 / 2.4f) - 0.055f);
        EXPECT_NEAR(last.texels[0].r, code, 2) << side;
        EXPECT_NEAR(last.texels[0].a, 255 - 255.0f / kPeriod, 2) << side;
        EXPECT_EQ(&levels.at(scene, 0, true, 0), &*scene.images[0]);
    }
    EXPECT_TRUE(TextureLevels(Scene{}).empty());
}

}  // namespace
}  // namespace phat::test
