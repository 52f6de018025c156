// Floors that go on under walls: no light comes through in what is drawn from a bake, diffuse or glossy.

#include <gtest/gtest.h>

#include "core/atlas/divided_surfaces.h"
#include "core/atlas/expected_texel_size.h"
#include "core/bake/bake.h"
#include "core/render/path_tracer.h"
#include "gl/renderer_world.h"
#include "support/divided_rooms.h"
#include "support/scene_parts.h"

namespace phat::test {
namespace {

constexpr float kDark = 1e-4f;  // of the light outside

class WallLeaks : public ::testing::TestWithParam<uint64_t> {
  protected:
    HeadlessContext context_;
};

// A closed room in two halves, one of them with a lamp, and one floor.
Scene halves() {
    Scene scene;
    addRoom(scene, lambert(0.6f), {4, 1, 2});
    addOutwardBox(scene, lambert(0.6f), {2.0f, -0.1f, -0.1f}, {0.02f, 1.2f, 2.2f});
    addQuad(scene, emitter(glm::vec3(4)), {0.5f, 0.98f, 0.5f}, {1, 0, 0}, {0, 0, 1});
    return scene;
}

struct Drawn {
    float brightest = 0;
    double mean = 0;
};

Drawn drawnOf(const Image& image) {
    Drawn drawn;
    for (const glm::vec3& pixel : image.pixels) {
        drawn.brightest = std::max(drawn.brightest, maxComponent(pixel));
        drawn.mean += double(luminance(pixel)) / double(image.pixels.size());
    }
    return drawn;
}

RendererWorld baked(const Scene& whole, uint64_t texels) {
    BakeSettings settings;
    settings.atlas.texelBudget = texels;
    settings.photons.count = 50'000;
    const Scene scene =
        withParts(whole, divideAtWalls(RayScene(whole), expectedTexelSizeMeters(whole, settings.atlas)));
    SilentProgress progress;
    Bake result = bake(scene, settings, progress);
    return {scene, std::move(result.atlas), std::move(result.points), std::move(result.phatexture)};
}

FrameSettings frameOf(const Camera& camera) {
    FrameSettings settings;
    settings.width = 96;
    settings.height = 64;
    settings.camera = camera;
    settings.samplesPerPixel = 4;
    return settings;
}

TEST_P(WallLeaks, TheSkyStaysOutside) {
    const RendererWorld world = baked(roomOnFloor(), GetParam());
    Renderer renderer(world.input(), kShaderFolder);
    for (const glm::vec3 target : {glm::vec3(-1, 0, -1), glm::vec3(1, 0, 0.3f), glm::vec3(0.9f, 1, 1)}) {
        const Image image = renderer.render(frameOf(lookAtCamera({0.1f, 0.5f, 0.1f}, target, 70)));
        EXPECT_LT(drawnOf(image).brightest, kDark) << "toward " << target.x << ' ' << target.z;
    }
    // Outside it is day: what is dark above is not dark everywhere.
    const Image outside = renderer.render(frameOf(lookAtCamera({2.5f, 1.5f, 2.5f}, {1.5f, 0, 1.5f}, 50)));
    EXPECT_GT(drawnOf(outside).mean, 0.3);
}

TEST_P(WallLeaks, OneHalfIsDarkAndTheOtherAsBrightAsPathsSay) {
    const Scene scene = halves();
    const RendererWorld world = baked(scene, GetParam());
    Renderer renderer(world.input(), kShaderFolder);
    const Camera dark = lookAtCamera({3.5f, 0.6f, 1}, {2.0f, 0, 1}, 60);
    EXPECT_LT(drawnOf(renderer.render(frameOf(dark))).brightest, kDark);

    const Camera bright = lookAtCamera({1, 0.9f, 1.01f}, {1, 0, 1}, 70);
    const RayScene rays(scene);
    const LightSampler lights(scene);
    PictureSettings settings;
    settings.width = 96;
    settings.height = 64;
    settings.camera = bright;
    SilentProgress progress;
    const double want =
        drawnOf(tracePicture(settings, pathTracer(rays, lights, Component::all), progress).mean).mean;
    // The paths' noise is a thousandth; the bake's irradiance is right to a few per cent.
    EXPECT_NEAR(drawnOf(renderer.render(frameOf(bright))).mean, want, 0.03 * want);
}

INSTANTIATE_TEST_SUITE_P(Texels, WallLeaks, ::testing::Values(20'000, 150'000));

}  // namespace
}  // namespace phat::test
