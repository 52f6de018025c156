// The renderer's pictures do not depend on the unit that their scene is in.

#include <gtest/gtest.h>

#include "core/bake/bake.h"
#include "core/render/metrics.h"
#include "core/scene/lights.h"
#include "gl/renderer_world.h"
#include "gl/traced_frame.h"
#include "support/scaled_scene.h"

namespace phat::test {
namespace {

struct Pictures {
    Image looked, traced, pyramid, direct, distances;
};

Pictures picturesAt(float factor) {
    const Scene scene = scaledScene(litTerrace(), factor);
    BakeSettings settings;
    settings.atlas.texelBudget = 20'000;
    settings.photons.count = 30'000;
    SilentProgress progress;
    const Bake baked = bake(scene, settings, progress);
    Renderer renderer({scene, baked.atlas, baked.points, baked.phatexture}, kShaderFolder);
    FrameSettings frame;
    frame.width = 96;
    frame.height = 72;
    frame.camera = scene.cameras[0];
    Pictures pictures;
    pictures.looked = renderer.render(frame);

    const RayScene rays(scene);
    const LightSampler lights(scene);
    const ReflectionScene reflections(rays, lights, baked.atlas, baked.points, baked.phatexture);
    const TracedReflections traced{reflections, Reflections::rays, progress};
    PictureSum sum;
    EXPECT_GT(drawFrame(renderer, frame, &traced, sum).rays, 1000u);
    pictures.traced = readMean(sum);

    frame.method = Method::phatPyramid;
    pictures.pyramid = renderer.render(frame);
    frame.method = Method::phat;
    frame.component = Component::direct;
    pictures.direct = renderer.render(frame);
    frame.component = Component::all;
    frame.inspection.what = Inspected::distance;
    pictures.distances = renderer.render(frame);
    return pictures;
}

// The random numbers are the same: what differs is where rounding of positions decides otherwise, in single
// pixels.
void expectSame(const Image& a, const Image& b, const char* what, bool exactly) {
    const Metrics error = compareImages(a, b);
    EXPECT_LT(std::abs(error.bias), exactly ? 1e-6 : kSameMean) << what;
    EXPECT_LT(error.maeOverMean, exactly ? 1e-6 : 0.02) << what;
}

TEST(RendererScale, PicturesAreTheSameInEveryUnit) {
    const HeadlessContext context;
    const Pictures inMeters = picturesAt(1);
    for (const float factor : kScales) {
        SCOPED_TRACE(factor);
        const Pictures pictures = picturesAt(factor);
        const bool exactly = factor == 1024;
        expectSame(pictures.looked, inMeters.looked, "looked up", exactly);
        expectSame(pictures.traced, inMeters.traced, "traced", exactly);
        expectSame(pictures.pyramid, inMeters.pyramid, "pyramid", exactly);
        expectSame(pictures.direct, inMeters.direct, "direct", exactly);
        expectSame(pictures.distances, inMeters.distances, "distances", exactly);
    }
}

// Without a near plane of its own a camera sees what is near and hides what is behind it, in scenes of any
// size.
TEST(RendererScale, CamerasWithoutANearPlaneFitTheScene) {
    const HeadlessContext context;
    Image first;
    for (const float factor : {1.0f, 1000.0f, 0.001f}) {
        Scene scene;
        addFloor(scene, emitter(glm::vec3(1)), 4);
        addFloor(scene, emitter(glm::vec3(3)), 1, 0.01f);
        const RendererWorld world = worldOfQuads(scaledScene(scene, factor), 2);
        Renderer renderer(world.input(), kShaderFolder);
        FrameSettings frame;
        frame.width = 64;
        frame.height = 48;
        frame.camera = lookAtCamera(factor * glm::vec3(0.5f, 1.5f, 2), glm::vec3(0), 50);
        frame.camera.znear = 0;
        const Image picture = renderer.render(frame);
        if (first.pixels.empty()) first = picture;
        EXPECT_LT(compareImages(picture, first).maeOverMean, 1e-3) << factor;
    }
    EXPECT_GT(first.at(32, 24).x, 2.9f);
}

}  // namespace
}  // namespace phat::test
