// Guides that the GPU makes from PHATexels.

#include <gtest/gtest.h>

#include "core/scene/light_bound.h"
#include "gl/light_world.h"

namespace phat::test {
namespace {

// A dark floor under a bright panel beside a dark one, of irradiance that PHATexels do not know of yet.
Scene floorUnderPanels() {
    Scene scene;
    addFloor(scene, lambert(0.5f), 8);
    addQuad(scene, lambert(0.5f), {-4, 2, -4}, {4, 0, 0}, {0, 0, 8});
    addQuad(scene, lambert(0.5f), {0, 2, -4}, {4, 0, 0}, {0, 0, 8});
    return scene;
}

struct PanelLight : LightWorld {
    PanelLight() : LightWorld(floorUnderPanels()) {
        setIrradiance(world, 1, 0.5f);
        setIrradiance(world, 2, 20);
    }
};

// As gather_guides.frag has it, of one round, by a loop over the PHATexels.
Guide guideOf(const LightWorld& gpu, const std::vector<PackedPhatexel>& phatexels, const Guide& before,
              uint32_t block) {
    const Atlas& atlas = gpu.world.atlas;
    std::array<double, kGuideCells> light{}, count{};
    for (size_t texel = 0; texel < atlas.texelCount(); ++texel) {
        if (atlas.blockAt({texel % atlas.sizeTexels.x, texel / atlas.sizeTexels.x}) != block) continue;
        const Phatexel phatexel = unpackPhatexel(phatexels[texel], 1);
        if (!phatexel.valid) continue;
        const glm::ivec2 cell = hemisphereToSquare(phatexel.directionBlock) * float(kGuideSize);
        const size_t i =
            size_t(std::min(cell.y, kGuideSize - 1) * kGuideSize + std::min(cell.x, kGuideSize - 1));
        light[i] += double(luminance(phatexel.radiance)) / before.weight[i];
        count[i] += 1.0 / before.weight[i];
    }
    std::array<float, kGuideCells> cells{};
    for (int i = 0; i < kGuideCells; ++i) {
        double sum = 0, all = 0;
        for (int k = 0; k < 9; ++k) {
            const int x = std::clamp(i % kGuideSize + k % 3 - 1, 0, kGuideSize - 1);
            const int y = std::clamp(i / kGuideSize + k / 3 - 1, 0, kGuideSize - 1);
            sum += light[size_t(y * kGuideSize + x)];
            all += count[size_t(y * kGuideSize + x)];
        }
        cells[size_t(i)] = float(sum / std::max(all, 1e-12));
    }
    return makeGuide(cells, 0.3f);
}

TEST(GpuGuides, AreThoseOfThePhatexels) {
    PanelLight gpu;
    Renderer renderer(gpu.input(), kShaderFolder);
    renderer.beginLight(gpu.input());
    renderer.traceLight(gpu.round(1, RayChoice::stored));
    const StoredLight before = renderer.readLight();
    renderer.traceLight(gpu.round(2));
    const StoredLight light = renderer.readLight();
    uint32_t differences = 0;
    for (uint32_t block = 0; block < gpu.world.atlas.blockCount; ++block) {
        const Guide want = guideOf(gpu, before.phatexels[0], before.guides[0][block], block);
        const Guide& found = light.guides[0][block];
        uint32_t total = 0;
        for (size_t i = 0; i < kGuideCells; ++i) {
            total += found.weight[i];
            // PHATexels whose rounded directions lie in another cell than they were drawn in count there or
            // nowhere.
            differences += std::abs(int(found.weight[i]) - int(want.weight[i])) > 0.1 * want.weight[i];
        }
        EXPECT_EQ(total, kGuideTotal);
    }
    EXPECT_LT(differences, gpu.world.atlas.blockCount * kGuideCells / 50);
}

// What was dark when the scene was baked is bright now: PHATexels look there.
TEST(GpuGuides, FollowNewLight) {
    PanelLight gpu;
    Renderer renderer(gpu.input(), kShaderFolder);
    renderer.beginLight(gpu.input());
    const auto toBright = [&] {
        double bright = 0, all = 0;
        forPhatexels(gpu, renderer.readLight(), 0, [&](size_t, glm::vec3, const Phatexel& phatexel) {
            bright += phatexel.radiance.x > 1;
            all += 1;
        });
        return bright / all;
    };
    renderer.traceLight(gpu.round(1, RayChoice::stored));
    const double before = toBright();
    for (uint32_t i = 2; i < 6; ++i) renderer.traceLight(gpu.round(i));
    // Texels of a block see the panel elsewhere, so that a third of its directions still miss it. Of
    // thousands of PHATexels the share is right to a fiftieth.
    EXPECT_GT(toBright(), 1.5 * before);
}

// The lookup's tables are those of the PHATexels: a renderer that is given both anew draws the same.
TEST(GpuGuides, AreShownWithTheirPhatexels) {
    PanelLight gpu;
    gpu.world.scene.materials[gpu.world.scene.surfaces[0].material] = metal(0.4f);
    Renderer renderer(gpu.input(), kShaderFolder);
    renderer.beginLight(gpu.input());
    for (uint32_t i = 1; i < 4; ++i) {
        LightRound round = gpu.round(i);
        round.irradiance = false;
        renderer.traceLight(round);
    }
    const StoredLight light = renderer.readLight();
    RendererWorld& world = gpu.world;
    world.phatexture.indirect[0].texels = light.phatexels[0];
    world.phatexture.area[0].texels = light.phatexels[1];
    world.phatexture.indirectGuides = light.guides[0];
    world.phatexture.areaGuides = light.guides[1];
    Renderer anew(gpu.input(), kShaderFolder);
    // Bounds of the radiance are not what this is about.
    for (Renderer* each : {&renderer, &anew}) {
        LightUpdate unbounded;
        unbounded.tileLight.assign(world.atlas.tileChart.size(), glm::vec4(glm::vec3(kUnbounded), 0));
        each->takeUpdate(unbounded, 1);
    }
    for (const Method method : {Method::phat, Method::phatPyramid}) {
        FrameSettings settings;
        settings.width = 64;
        settings.height = 48;
        settings.samplesPerPixel = 1;
        settings.method = method;
        settings.camera = lookAtCamera({0, 1, 3.5f}, {0.5f, 0, 0}, 60);
        const Image found = renderer.render(settings), want = anew.render(settings);
        double sum = 0, off = 0;
        for (size_t i = 0; i < want.pixels.size(); ++i) {
            sum += double(want.pixels[i].x);
            off += double(std::abs(found.pixels[i].x - want.pixels[i].x));
        }
        EXPECT_GT(sum, 100);
        EXPECT_LT(off, 1e-3 * sum) << int(method);
    }
}

}  // namespace
}  // namespace phat::test
