// Views of what the atlas holds, pixel by pixel against the CPU's reading of the same texels.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <optional>

#include "core/phatexel/directions.h"
#include "core/phatexel/lookup_tables.h"
#include "core/render/picture.h"
#include "core/scene/rays.h"
#include "gl/renderer_world.h"

namespace phat::test {
namespace {

class Inspect : public ::testing::Test {
  protected:
    Inspect() : world_(worldOfQuads(quads(), 4)), rays_(world_.scene) {
        const auto light = [](glm::vec3 p, glm::vec3 w) {
            return glm::vec3(1 + w.x, 1 + p.x * p.x, 0.5f + 0.5f * w.z);
        };
        fillPhatexels(world_, 0, light, 0.3f);
        fillPhatexels(world_, 1, light);
        // Every fifth texel holds nothing.
        for (size_t i = 0; i < world_.phatexture.indirect[0].texels.size(); i += 5)
            world_.phatexture.indirect[0].texels[i] = {};
        camera_ = lookAtCamera({0.3f, 2, 2.5f}, {0, 0.2f, 0}, 50);
    }

    static Scene quads() {
        Scene scene;
        Material material;
        material.metallic = 1;
        material.roughness = 0.5f;
        addQuad(scene, material, {-1, 0, 1}, {2, 0, 0}, {0, 0, -2});
        addQuad(scene, material, {-1, 0, -1}, {2, 0, 0}, {0, 1, 0});
        return scene;
    }

    Image shown(Inspection inspection, int samples = 1) {
        if (!renderer_) renderer_.emplace(world_.input(), kShaderFolder);
        FrameSettings settings;
        settings.width = kWidth;
        settings.height = kHeight;
        settings.camera = camera_;
        settings.samplesPerPixel = samples;
        settings.inspection = inspection;
        return renderer_->render(settings);
    }

    // The share of the pixels on surfaces that show what `expected` makes of their texel.
    template <class Expected>
    double agreement(const Image& image, const Expected& expected) {
        size_t agree = 0, all = 0;
        for (int y = 0; y < kHeight; ++y) {
            for (int x = 0; x < kWidth; ++x) {
                uint64_t count = 0;
                const Ray ray = cameraRay(camera_, kWidth, kHeight, glm::vec2(x, y) + 0.5f);
                const Hit hit = visibleHit(rays_, ray, count);
                if (!hit) continue;
                const auto& corners = world_.atlas.triangleTexels[hit.triangle];
                const glm::vec2 position = corners[0] + hit.barycentric.x * (corners[1] - corners[0]) +
                                           hit.barycentric.y * (corners[2] - corners[0]);
                const glm::uvec2 texel(position);
                const glm::vec3 want = expected(texel);
                const glm::vec3 apart = glm::abs(image.at(x, y) - want);
                ++all;
                agree += std::max({apart.x, apart.y, apart.z}) < 0.01f * (1 + maxComponent(want));
            }
        }
        EXPECT_GT(all, size_t(kWidth * kHeight / 5));
        return double(agree) / double(all);
    }

    // Directions that can be looked up; what is stored of them does not count here.
    void followTheLayout() {
        const Atlas& atlas = world_.atlas;
        PhatexelLayer& layer = world_.phatexture.indirect[0];
        layer.scrambles.assign(atlas.blockCount, 0);
        for (uint32_t y = 0; y < atlas.sizeTexels.y; ++y)
            for (uint32_t x = 0; x < atlas.sizeTexels.x; ++x) {
                const glm::uvec2 inBlock =
                    (glm::uvec2(x, y) - atlas.charts[atlas.chartAt({x, y})].originTexel()) % kBlockSize;
                Phatexel phatexel;
                phatexel.directionBlock =
                    squareToGuide(world_.phatexture.indirectGuides[atlas.blockAt({x, y})],
                                  stratifiedSquare(inBlock, 0, glm::vec2(0.5f)));
                phatexel.radiance = glm::vec3(1);
                phatexel.distance = 1;
                phatexel.valid = true;
                layer.texels[size_t(y) * atlas.sizeTexels.x + x] = packPhatexel(phatexel, 1);
            }
        SilentProgress silent;
        prepareLookup(world_.phatexture, atlas, world_.points, blockFrames(atlas, world_.points), rays_,
                      silent);
    }

    Phatexel stored(glm::uvec2 texel) const {
        return unpackPhatexel(
            world_.phatexture.indirect[0].texels[texel.y * world_.atlas.sizeTexels.x + texel.x], 1);
    }

    static constexpr int kWidth = 160, kHeight = 120;
    // Rounding decides about pixels on the border of two texels.
    static constexpr double kOnBorders = 0.995;
    HeadlessContext context_;
    RendererWorld world_;
    RayScene rays_;
    Camera camera_;
    std::optional<Renderer> renderer_;
};

const glm::vec3 kNothing(0.02f), kInvalid(0.8f, 0.02f, 0.1f);

TEST_F(Inspect, RadianceIsWhatIsStored) {
    EXPECT_GT(agreement(shown({Inspected::radiance}),
                        [&](glm::uvec2 t) { return stored(t).valid ? stored(t).radiance : kNothing; }),
              kOnBorders);
}

TEST_F(Inspect, DirectionsAreOfTheWorld) {
    const std::vector<Frame> frames = blockFrames(world_.atlas, world_.points);
    EXPECT_GT(agreement(shown({Inspected::direction}),
                        [&](glm::uvec2 t) {
                            if (!stored(t).valid) return kNothing;
                            const Frame& frame = frames[world_.atlas.blockAt(t)];
                            return 0.5f + 0.5f * frame.toWorld(stored(t).directionBlock);
                        }),
              kOnBorders);
}

TEST_F(Inspect, DistancesAreHeat) {
    const Image image = shown({Inspected::distance});
    EXPECT_GT(agreement(image,
                        [&](glm::uvec2 t) {
                            if (!stored(t).valid) return kNothing;
                            const float heat = std::log2(stored(t).distance / 0.01f) / std::log2(1e4f);
                            return glm::clamp(3 * heat - glm::vec3(0, 1, 2), 0.0f, 1.0f);
                        }),
              kOnBorders);
}

TEST_F(Inspect, ValidityTellsWhereNothingIs) {
    EXPECT_GT(
        agreement(shown({Inspected::validity}),
                  [&](glm::uvec2 t) { return stored(t).valid ? glm::vec3(0.05f, 0.4f, 0.1f) : kInvalid; }),
        kOnBorders);
}

TEST_F(Inspect, DensityIsACheckerOfTexels) {
    const Image image = shown({Inspected::density});
    EXPECT_GT(agreement(image,
                        [&](glm::uvec2 t) {
                            const float odd = float((t.x + t.y) & 1u),
                                        oddTile = float((t.x / 8 + t.y / 8) & 1u);
                            return glm::vec3(0.1f, 0.25f, 0.9f) * (0.35f + 0.4f * odd + 0.25f * oddTile);
                        }),
              kOnBorders);
}

TEST_F(Inspect, ChartsDifferFromEachOther) {
    const Image image = shown({Inspected::charts});
    std::vector<glm::vec3> first;
    agreement(image, [&](glm::uvec2) { return glm::vec3(0); });
    for (const glm::vec3& pixel : image.pixels)
        if (maxComponent(pixel) > 0 && std::none_of(first.begin(), first.end(), [&](glm::vec3 c) {
                return glm::distance(c, pixel) < 1e-3f;
            }))
            first.push_back(pixel);
    EXPECT_EQ(first.size(), 4u);  // two charts, each with light and dark tiles
}

TEST_F(Inspect, ThePyramidsLowestLevelIsTheTexelsOwnLight) {
    // One sample a texel: whatever the lobe weighs it by, the mean is the sample. Seen from above every lobe
    // weighs.
    const Image image = shown({Inspected::pyramid, 0, 0, 0});
    EXPECT_GT(agreement(image, [&](glm::uvec2 t) { return stored(t).valid ? stored(t).radiance : kNothing; }),
              0.9);
    const Image coarse = shown({Inspected::pyramid, 0, 0, 3});
    // A tile is one colour, between the texels' own.
    std::vector<glm::vec3> colors;
    for (const glm::vec3& pixel : coarse.pixels)
        if (std::find(colors.begin(), colors.end(), pixel) == colors.end()) colors.push_back(pixel);
    EXPECT_LE(colors.size(), 33u);
    EXPECT_GT(colors.size(), 20u);
}

// A single PHATexel in reach counts as one however the cone weighs it; many that weigh alike as many.
TEST_F(Inspect, SampleCountsAreEffectiveNumbers) {
    const auto heatOf = [](double count) { return std::min(3 * std::log2(count) / 8, 1.0); };  // red
    const auto meanRed = [](const Image& image) {
        double sum = 0;
        size_t pixels = 0;
        for (const glm::vec3& pixel : image.pixels) {
            if (pixel == kInvalid || pixel == glm::vec3(0, 0, 0)) continue;
            sum += double(pixel.x);
            ++pixels;
        }
        return pixels > 0 ? sum / double(pixels) : 0.0;
    };
    EXPECT_GT(meanRed(shown({Inspected::samples})), heatOf(3));
    auto& texels = world_.phatexture.indirect[0].texels;
    const uint32_t width = world_.atlas.sizeTexels.x;
    for (uint32_t i = 0; i < texels.size(); ++i)
        if (i % width % 32 != 16 || i / width != 16) texels[i] = {};
    renderer_.reset();
    const Image sparse = shown({Inspected::samples});
    size_t ones = 0;
    for (const glm::vec3& pixel : sparse.pixels) {
        if (pixel == glm::vec3(0)) continue;  // no surface, or one
        EXPECT_LT(glm::distance(pixel, kInvalid), 1e-5f);
    }
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
            uint64_t count = 0;
            const Ray ray = cameraRay(camera_, kWidth, kHeight, glm::vec2(x, y) + 0.5f);
            ones += visibleHit(rays_, ray, count) && sparse.at(x, y) == glm::vec3(0);
        }
    EXPECT_GT(ones, 100u);
}

TEST_F(Inspect, ReadsAreWholeNumbers) {
    followTheLayout();
    const Image image = shown({Inspected::reads});
    const ReadCount reads = countReads(image, 0);
    EXPECT_GT(reads.mean, 10);
    EXPECT_LT(reads.most, 500);
    for (const glm::vec3& pixel : image.pixels) EXPECT_EQ(pixel.x, std::round(pixel.x));
}

// A coat is a second lobe: what is looked up, pooledSums and displayed of it counts as the base's does.
TEST_F(Inspect, ReadsOfTheClearCoatCount) {
    followTheLayout();
    const double base = countReads(shown({Inspected::reads}), 0).mean;
    std::vector<Material> materials = world_.scene.materials;
    for (Material& material : materials) {
        material.clearcoat = 1;
        material.clearcoatRoughness = material.roughness;
    }
    renderer_->setMaterials(materials);
    // Coat and base have one normal and one roughness, so the same directions; the bound of the radiance is
    // read once for both.
    EXPECT_NEAR(countReads(shown({Inspected::reads}), 0).mean, 2 * base - 1, 0.01 * base);
}

// Views and methods take turns in a window.
TEST_F(Inspect, LeavesThePicturesAsTheyAre) {
    followTheLayout();
    FrameSettings settings;
    settings.width = kWidth;
    settings.height = kHeight;
    settings.camera = camera_;
    settings.samplesPerPixel = 1;
    std::vector<Image> alone;
    const Method methods[] = {Method::phat, Method::phatPyramid, Method::phatPaper};
    for (const Method method : methods) {
        settings.method = method;
        alone.push_back(Renderer(world_.input(), kShaderFolder).render(settings));
    }
    shown({Inspected::radiance});
    for (int round = 0; round < 2; ++round) {
        for (size_t i = 0; i < std::size(methods); ++i) {
            settings.method = methods[i];
            EXPECT_EQ(renderer_->render(settings).pixels, alone[i].pixels);
            shown({Inspected::reads});
            shown({Inspected::samples});
        }
    }
}

TEST_F(Inspect, KnowsWhatItKeepsInMemory) {
    shown({Inspected::nothing});
    const ResidentBytes bytes = renderer_->residentBytes();
    const uint64_t texels = world_.atlas.texelCount();
    EXPECT_EQ(bytes.phatexels, 8 * texels);
    EXPECT_EQ(bytes.irradiance,
              2 * 8 * texels);  // indirect and area, four halves each, of which one is spare
    EXPECT_GE(bytes.pyramid, 24 * texels);
    EXPECT_GE(bytes.frame, uint64_t(20 * kWidth * kHeight));
}

// Each part is a bit: the sum has them all, once.
TEST(ResidentBytes, SumCountsEveryPartOnce) {
    constexpr size_t kParts = sizeof(ResidentBytes) / sizeof(uint64_t);
    std::array<uint64_t, kParts> bits;
    for (size_t i = 0; i < kParts; ++i) bits[i] = uint64_t(1) << i;
    EXPECT_EQ(std::bit_cast<ResidentBytes>(bits).sum(), (uint64_t(1) << kParts) - 1);
}

}  // namespace
}  // namespace phat::test
