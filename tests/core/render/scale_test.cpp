// Pictures that are made on the CPU do not depend on the unit that their scene is in.

#include <gtest/gtest.h>

#include "core/bake/bake.h"
#include "core/render/metrics.h"
#include "core/render/path_tracer.h"
#include "core/render/phat_gather.h"
#include "support/scaled_scene.h"

namespace phat {
namespace {

using namespace test;

struct Pictures {
    Image path, gathered;
};

Image pictureOf(const Camera& camera, const Integrator& integrator, int samples) {
    PictureSettings settings;
    settings.width = 48;
    settings.height = 36;
    settings.camera = camera;
    settings.samplesPerPixel = samples;
    SilentProgress progress;
    return tracePicture(settings, integrator, progress).mean;
}

Pictures picturesAt(float factor) {
    const Scene scene = scaledScene(litTerrace(), factor);
    const RayScene rays(scene);
    const LightSampler lights(scene);
    BakeSettings settings;
    settings.atlas.texelBudget = 10'000;
    settings.photons.count = 30'000;
    SilentProgress progress;
    const Bake baked = bake(scene, settings, progress);
    const Camera& camera = scene.cameras[0];
    return {
        pictureOf(camera, pathTracer(rays, lights, Component::all), 16),
        pictureOf(camera, phatGather({rays, lights, baked.atlas, baked.points, baked.phatexture}, {}), 1)};
}

// The random numbers are the same, so that few pixels differ by more than rounding.
void expectSame(const Image& a, const Image& b) {
    const Metrics error = compareImages(a, b);
    EXPECT_LT(std::abs(error.bias), kSameMean);
    EXPECT_LT(error.maeOverMean, 0.02);
}

TEST(ScaleOfPictures, PathsAndGatheringAreTheSameInEveryUnit) {
    const Pictures inMeters = picturesAt(1);
    for (const float factor : kScales) {
        SCOPED_TRACE(factor);
        const Pictures pictures = picturesAt(factor);
        expectSame(pictures.path, inMeters.path);
        expectSame(pictures.gathered, inMeters.gathered);
    }
}

}  // namespace
}  // namespace phat
