// The renderer while a scene moves: a new one would draw the same.

#include <gtest/gtest.h>

#include <glm/gtc/matrix_transform.hpp>

#include "core/bake/bake.h"
#include "core/dynamic/incremental_baker.h"
#include "gl/renderer_world.h"

namespace phat {
namespace {

using namespace test;

double difference(const Image& a, const Image& b) {
    double sum = 0;
    for (size_t i = 0; i < a.pixels.size(); ++i) sum += glm::length(a.pixels[i] - b.pixels[i]);
    return sum;
}

TEST(LiveRenderer, DrawsWhatANewRendererDraws) {
    Scene scene;
    Material metal = lambert(0.7f);
    metal.metallic = 1;
    metal.roughness = 0.35f;
    addRoom(scene, lambert(0.6f), {1, 1, 1});
    scene.materials[scene.surfaces[2].material] = metal;  // the floor
    addQuad(scene, metal, {0.3f, 0.05f, 0.4f}, {0.2f, 0, 0}, {0, 0.3f, 0});
    scene.surfaces.back().node = 1;
    scene.materials.back().doubleSided = true;
    addQuad(scene, emitter(glm::vec3(4), 0.5f), {0.3f, 0.98f, 0.3f}, {0.4f, 0, 0}, {0, 0, 0.4f});
    scene.lights = {pointLight(glm::vec3(0.3f), {0.7f, 0.6f, 0.8f})};

    BakeSettings settings;
    settings.atlas.texelBudget = 30'000;
    settings.photons.count = 20'000;
    settings.pathsPerPhatexel = 2;
    SilentProgress progress;
    const Bake baked = bake(scene, settings, progress);
    PosedScene posed(scene);
    IncrementalBaker engine(posed.snapshot(), baked.atlas, baked.points, baked.phatexture, settings);

    const HeadlessContext context;
    Renderer renderer({engine.scene().scene(), baked.atlas, engine.scene().points(), engine.phatexture()},
                      kShaderFolder);
    FrameSettings frame;
    frame.width = 160;
    frame.height = 120;
    frame.samplesPerPixel = 1;
    frame.camera = lookAtCamera({0.5f, 0.6f, 0.97f}, {0.5f, 0.2f, 0.3f}, 60);
    constexpr std::array kMethods = {Method::phat, Method::phatPyramid};
    std::array<Image, 2> before;
    for (size_t i = 0; i < kMethods.size(); ++i) {
        frame.method = kMethods[i];
        before[i] = renderer.render(frame);
    }
    const Image black(frame.width, frame.height);
    for (int step = 1; step <= 3; ++step) {
        SceneState pose{{}, scene.lights, scene.materials};
        glm::mat4 m = glm::translate(glm::mat4(1), {0.05f * float(step), 0, 0.1f});
        pose.worldFromRest = {glm::mat4(1), glm::rotate(m, 0.05f * float(step), {0.3f, 0.9f, 0.3f})};
        pose.lights[0].position.y = 0.6f - 0.1f * float(step);
        posed.setState(pose);
        ASSERT_TRUE(engine.setScene(posed.snapshot()));
        renderer.moveScene(engine.scene().scene(), baked.atlas, engine.scene().points(), pose.worldFromRest);
        engine.advance(step == 3 ? 1'000'000'000 : 400'000, progress);
        LightUpdate update = engine.drainUpdate();
        // In portions, of no time at all: each call does at least one.
        int calls = 1;
        while (!renderer.takeUpdate(update, 0)) ASSERT_LT(++calls, 100'000);
        EXPECT_GT(calls, step == 3 ? 2 : 0);  // the first answers may fit into one
        Renderer fresh({engine.scene().scene(), baked.atlas, engine.scene().points(), engine.phatexture()},
                       kShaderFolder);
        for (size_t i = 0; i < kMethods.size(); ++i) {
            frame.method = kMethods[i];
            const Image expected = fresh.render(frame);
            const double sum = difference(expected, black);
            // Of the brightest light of tiles the engine tells only now and then; when all is settled,
            // everything is the same.
            EXPECT_LE(difference(renderer.render(frame), expected), (step == 3 ? 0 : 1e-3) * sum)
                << step << i;
            EXPECT_GT(difference(expected, before[i]), 0.02 * sum) << step << i;
        }
    }
    EXPECT_TRUE(engine.converged());
}

}  // namespace
}  // namespace phat
