// Light that the GPU makes: closed forms on quads, and the furnace.

#include <gtest/gtest.h>

#include <glm/gtc/matrix_transform.hpp>

#include "core/bake/bake.h"
#include "core/dynamic/incremental_baker.h"
#include "core/phatexel/radiance_bound.h"
#include "core/scene/light_bound.h"
#include "gl/light_turns.h"
#include "gl/light_world.h"

namespace phat::test {
namespace {

TEST(GpuLight, PhatexelsHoldWhatTheirRaysMeet) {
    for (const RayChoice directions : {RayChoice::stored, RayChoice::guided}) {
        LightWorld gpu(floorAndCeiling(lambert(0.5f), lambert(0.5f)));
        setIrradiance(gpu.world, 1, 3);
        Renderer renderer(gpu.input(), kShaderFolder);
        renderer.beginLight(gpu.input());
        renderer.traceLight(gpu.round(1, directions));
        size_t hits = 0, misses = 0, moved = 0;
        forPhatexels(gpu, renderer.readLight(), 0, [&](size_t texel, glm::vec3 d, const Phatexel& found) {
            const glm::vec3 end = gpu.world.points.position[texel] + d * (2 / d.y);
            moved += found.directionBlock !=
                     unpackPhatexel(gpu.world.phatexture.indirect[0].texels[texel], 1).directionBlock;
            // Directions of tile patches are rounded.
            const float edge = std::max(std::abs(end.x), std::abs(end.z)) - 4;
            if (std::abs(edge) < 0.05f * glm::length(end)) return;
            (edge < 0 ? hits : misses) += 1;
            ASSERT_NEAR(found.radiance.x, edge < 0 ? 0.5f * 3 / kPi : 0, 2e-3f);
            if (edge < 0) {
                ASSERT_NEAR(found.distance * d.y, 2, 0.12f);
            } else {
                ASSERT_EQ(found.distance, kFarDistance);
            }
        });
        EXPECT_GT(hits, 1000u);
        EXPECT_GT(misses, 100u);
        EXPECT_EQ(moved > 0, directions == RayChoice::guided);
    }
}

// Each direction of the guide's is chosen as often as it says, and where the lookup expects it.
TEST(GpuLight, NewDirectionsFollowTheGuideAndTheLayout) {
    LightWorld gpu(floorAndCeiling(lambert(0.5f), lambert(0.5f)));
    Renderer renderer(gpu.input(), kShaderFolder);
    renderer.beginLight(gpu.input());
    renderer.traceLight(gpu.round(5));
    const StoredLight light = renderer.readLight();
    const Atlas& atlas = gpu.world.atlas;
    const PhatexelLayer& layer = gpu.world.phatexture.indirect[0];
    size_t checked = 0, astray = 0;
    for (size_t texel = 0; texel < atlas.texelCount(); ++texel) {
        const Phatexel phatexel = unpackPhatexel(light.phatexels[0][texel], 1);
        if (!phatexel.valid) continue;
        const glm::uvec2 xy(texel % atlas.sizeTexels.x, texel / atlas.sizeTexels.x);
        const uint32_t block = atlas.blockAt(xy);
        const glm::uvec2 inBlock = (xy - atlas.charts[atlas.chartAt(xy)].originTexel()) % kBlockSize;
        const glm::vec2 cell =
            float(kBlockSize) * stratifiedSquare(inBlock, layer.scrambles[block], glm::vec2(0));
        const glm::vec2 square =
            float(kBlockSize) * guideToSquare(light.guides[0][block], phatexel.directionBlock);
        // Directions are rounded to 24 bits; near the border of a row of the guide, into the next one.
        const bool inside =
            glm::all(glm::greaterThan(square, cell - 0.1f)) && glm::all(glm::lessThan(square, cell + 1.1f));
        astray += !inside;
        ++checked;
    }
    EXPECT_GT(checked, 4000u);
    EXPECT_LT(astray, checked / 100);
}

// What meets the same sees the same; half of the light is a change by a half.
TEST(GpuLight, ChecksTellWhatHasChanged) {
    Scene scene = floorAndCeiling(lambert(0.3f), lambert(0.5f));
    scene.lights = {pointLight(glm::vec3(4), {0.3f, 1, 0.2f})};
    LightWorld gpu(std::move(scene));
    Renderer renderer(gpu.input(), kShaderFolder);
    renderer.beginLight(gpu.input());
    const auto changes = [&](uint32_t number) {
        LightRound round = gpu.round(number, RayChoice::stored);
        round.irradiance = false;
        round.compares = true;
        return renderer.traceLight(round);
    };
    // From PHATexels that were made up.
    for (const float change : changes(1)) EXPECT_GT(change, 0.1f);
    changes(2);
    for (const float change : changes(3)) EXPECT_EQ(change, 0.0f);
    std::vector<PunctualLight> dimmed = gpu.world.scene.lights;
    dimmed[0].intensity *= 0.5f;
    renderer.setLights(dimmed);
    // Radiance is stored to a fivehundredth.
    for (const float change : changes(4)) EXPECT_NEAR(change, 0.5f, 0.005f);
}

// As tileLight() says of the PHATexels that the GPU has made.
TEST(GpuLight, BoundsFollowThePhatexels) {
    Scene scene = floorAndCeiling(lambert(0.5f), lambert(0.5f));
    addQuad(scene, emitter(glm::vec3(7)), {-0.5f, 1.5f, -0.5f}, {1, 0, 0}, {0, 0, 1});
    LightWorld gpu(std::move(scene));
    Renderer renderer(gpu.input(), kShaderFolder);
    const std::vector<glm::vec4> before = renderer.readLight().tileLight;
    renderer.beginLight(gpu.input());
    renderer.unboundLight();
    const std::vector<glm::vec4> unbounded = renderer.readLight().tileLight;
    for (uint32_t number = 1; number <= 3; ++number) renderer.traceLight(gpu.round(number));
    renderer.boundLight();
    const StoredLight light = renderer.readLight();
    Phatexture made = gpu.world.phatexture;
    made.indirect[0].texels = light.phatexels[0];
    made.area[0].texels = light.phatexels[1];
    const std::vector<glm::vec4> expected = tileLight(gpu.world.scene, gpu.world.atlas, made);
    size_t changed = 0;
    for (size_t tile = 0; tile < expected.size(); ++tile) {
        if (gpu.world.atlas.tileChart[tile] == kNoChart) continue;
        EXPECT_EQ(unbounded[tile], glm::vec4(glm::vec3(kUnbounded), before[tile].a));
        // Light of both sources adds up.
        EXPECT_GE(light.tileLight[tile].x, expected[tile].x * 0.999f);
        EXPECT_LE(light.tileLight[tile].x, std::min(2 * expected[tile].x, 7.0f));
        EXPECT_EQ(light.tileLight[tile].a, before[tile].a);
        changed += light.tileLight[tile].x != before[tile].x;
    }
    EXPECT_GT(changed, 10u);
}

// The irradiance of a horizontal panel of radiance 1 over the origin, by integration.
double panelOverFloor(float side, float height, glm::vec3 place) {
    constexpr int kSteps = 100;
    double sum = 0;
    for (int i = 0; i < kSteps * kSteps; ++i) {
        const glm::vec2 on = side * ((glm::vec2(i % kSteps, i / kSteps) + 0.5f) / float(kSteps) - 0.5f);
        const glm::vec3 way = glm::vec3(on.x, height, on.y) - place;
        const double squared = double(glm::dot(way, way));
        sum += square(double(side) / kSteps) * square(double(height)) / (squared * squared);
    }
    return sum;
}

// A panel over the middle of a floor, small, wide, and seen past an edge: by integration over it.
TEST(GpuLight, IrradianceOfAPanel) {
    struct Case {
        float side, height;
        glm::vec3 at;
    };
    for (const Case& c :
         {Case{0.2f, 1, {0, 0, 0}}, Case{4, 1, {0.3f, 0, 0.2f}}, Case{1, 1.5f, {1, 0, 0.5f}}}) {
        Scene scene;
        addFloor(scene, lambert(0.5f), 4);
        addCeiling(scene, emitter(glm::vec3(6)), c.side, c.height);
        LightWorld gpu(std::move(scene));
        Renderer renderer(gpu.input(), kShaderFolder);
        renderer.beginLight(gpu.input());
        for (uint32_t i = 1; i <= 256; ++i) {
            LightRound round = gpu.round(i);
            round.phatexels = false;
            renderer.traceLight(round);
        }
        renderer.filterLight();
        const StoredLight light = renderer.readLight();
        const size_t middle = gpu.texelNear(0, c.at), wide = gpu.world.atlas.sizeTexels.x;
        double found = 0, expected = 0;
        for (size_t i = 0; i < 169; ++i) {
            const size_t texel = middle + (i / 13) * wide + i % 13 - 6 * wide - 6;
            found += double(light.irradiance[1][texel].x);
            expected += 6 * panelOverFloor(c.side, c.height, gpu.world.points.position[texel]);
        }
        EXPECT_NEAR(found, expected, 0.01 * expected) << c.side;
    }
}

// In a closed box whose walls emit 1 and reflect a half, radiance is 2 wherever one looks: bounces arrive by
// repetition, and stay.
TEST(GpuLight, FurnaceSettlesAndDoesNotDrift) {
    Scene scene;
    addRoom(scene, emitter(glm::vec3(1), 0.5f), {1, 1, 1});
    BakeSettings settings;
    settings.atlas.texelBudget = 3000;
    settings.photons.count = 2000;
    settings.pathsPerPhatexel = 1;
    SilentProgress progress;
    Bake baked = bake(scene, settings, progress);
    const SceneBvh bvh = buildSceneBvh(scene);
    // From darkness.
    baked.phatexture.indirectIrradiance.assign(baked.atlas.texelCount(), 0);
    baked.phatexture.areaIrradiance.assign(baked.atlas.texelCount(), 0);
    const HeadlessContext context;
    Renderer renderer({scene, baked.atlas, baked.points, baked.phatexture, &bvh}, kShaderFolder);
    renderer.beginLight({scene, baked.atlas, baked.points, baked.phatexture});
    const auto run = [&](uint32_t first, uint32_t rounds) {
        for (uint32_t i = first; i < first + rounds; ++i) {
            const std::vector<BlockTurn> blocks = turnsOf(baked.atlas, i);
            renderer.traceLight({.blocks = blocks, .number = i, .directions = RayChoice::guided});
            renderer.filterLight();
        }
    };
    const auto radiance = [&] {
        const StoredLight light = renderer.readLight();
        double irradiance = 0, phatexels = 0, texels = 0, valid = 0;
        for (size_t i = 0; i < baked.points.state.size(); ++i) {
            if (baked.points.state[i] != TexelState::surface) continue;
            irradiance += double(light.irradiance[0][i].x + light.irradiance[1][i].x);
            texels += 1;
            const Phatexel indirect = unpackPhatexel(light.phatexels[0][i], baked.atlas.unitMeters);
            const Phatexel area = unpackPhatexel(light.phatexels[1][i], baked.atlas.unitMeters);
            if (!indirect.valid || !area.valid) continue;
            phatexels += double(indirect.radiance.x + area.radiance.x);
            valid += 1;
        }
        return glm::dvec2(irradiance / texels / double(kPi), phatexels / valid);
    };
    run(0, BlockOrder::kSettledRounds);
    const glm::dvec2 settled = radiance();
    EXPECT_NEAR(settled.x, 2, 0.01);
    EXPECT_NEAR(settled.y, 2, 0.01);
    run(BlockOrder::kSettledRounds, 256);
    const glm::dvec2 late = radiance();
    EXPECT_NEAR(late.x, 2, 0.01);
    EXPECT_NEAR(late.y, 2, 0.01);
}

// A lamp that is dimmed and a box that moves: in the end the light is that of a bake of what is there now.
TEST(GpuLight, SettlesToABakeOfTheChangedScene) {
    Scene scene;
    addRoom(scene, lambert(0.5f), {1, 1, 1});
    addOutwardBox(scene, lambert(0.3f), {0.1f, 0.001f, 0.35f}, {0.3f, 0.3f, 0.3f});
    for (size_t i = 6; i < scene.surfaces.size(); ++i) scene.surfaces[i].node = 1;
    addQuad(scene, emitter(glm::vec3(8)), {0.4f, 0.98f, 0.4f}, {0.2f, 0, 0}, {0, 0, 0.2f});
    scene.lights = {pointLight(glm::vec3(0.4f), {0.8f, 0.8f, 0.2f})};
    BakeSettings settings;
    settings.atlas.texelBudget = 12'000;
    settings.photons.count = 20'000;
    settings.pathsPerPhatexel = 1;
    SilentProgress progress;
    const Bake baked = bake(scene, settings, progress);
    const SceneBvh bvh = buildSceneBvh(scene);
    PosedScene posed(scene);
    IncrementalBaker engine(posed.snapshot(), baked.atlas, baked.points, baked.phatexture, settings);
    const HeadlessContext context;
    Renderer renderer({scene, baked.atlas, baked.points, baked.phatexture, &bvh}, kShaderFolder);

    SceneState pose{{}, scene.lights, scene.materials};
    pose.lights[0].intensity *= 0.5f;
    pose.worldFromRest = {glm::mat4(1), glm::translate(glm::mat4(1), {0.4f, 0, 0.1f})};
    posed.setState(pose);
    ASSERT_TRUE(engine.setScene(posed.snapshot()));
    renderer.moveScene(engine.scene().scene(), baked.atlas, engine.scene().points(), pose.worldFromRest);
    renderer.setLights(pose.lights);
    // Of the geometry alone.
    LightUpdate geometry = engine.drainUpdate();
    while (!renderer.takeUpdate(geometry, 1)) continue;
    renderer.beginLight({scene, baked.atlas, baked.points, baked.phatexture});
    BlockOrder order(baked.atlas, baked.points);
    const Camera eye = lookAtCamera({0.5f, 0.6f, 0.9f}, {0.5f, 0.2f, 0.3f}, 60);
    for (uint32_t number = 0; !order.settled();) {
        takeTurns(renderer, order, order.next(order.size(), eye), number);
        renderer.filterLight();
    }
    const StoredLight light = renderer.readLight();
    engine.converge(progress);
    const Phatexture& expected = engine.phatexture();
    std::array<double, 2> before{}, now{}, changed{}, error{};
    for (size_t i = 0; i < baked.points.state.size(); ++i) {
        if (engine.scene().points().state[i] != TexelState::surface) continue;
        const std::array old = {luminance(unpackRgb9e5(baked.phatexture.indirectIrradiance[i])),
                                luminance(unpackRgb9e5(baked.phatexture.areaIrradiance[i]))};
        const std::array want = {luminance(unpackRgb9e5(expected.indirectIrradiance[i])),
                                 luminance(unpackRgb9e5(expected.areaIrradiance[i]))};
        for (size_t s = 0; s < 2; ++s) {
            const float found = luminance(light.irradiance[s][i]);
            before[s] += double(want[s]);
            now[s] += double(found);
            changed[s] += double(std::abs(want[s] - old[s]));
            error[s] += double(std::abs(want[s] - found));
        }
    }
    for (size_t s = 0; s < 2; ++s) {
        EXPECT_NEAR(now[s] / before[s], 1, 0.02) << s;
        // The noise of rounds and of the bake.
        EXPECT_LT(error[s], 0.04 * before[s]) << s;
        EXPECT_GT(changed[s], 2 * error[s]) << s;
    }
}

}  // namespace
}  // namespace phat::test
