// What is before what, also far from a near plane that is close to the eye.

#include <gtest/gtest.h>

#include "gl/renderer_world.h"

namespace phat::test {
namespace {

// A dark square, and a bright one behind it by a thousandth of the distance, drawn in either order.
Scene squaresAt(float distance, bool brightFirst) {
    Scene scene;
    const auto add = [&](float z, float nit) {
        addQuad(scene, emitter(glm::vec3(nit)), {-distance, -distance, -z}, {2 * distance, 0, 0},
                {0, 2 * distance, 0});
    };
    if (brightFirst) add(1.001f * distance, 5);
    add(distance, 0.25f);
    if (!brightFirst) add(1.001f * distance, 5);
    return scene;
}

TEST(RendererDepth, ThingsFarAwayHideEachOther) {
    const HeadlessContext context;
    for (const float distance : {0.05f, 1.0f, 30.0f, 1000.0f, 50'000.0f})
        for (const bool brightFirst : {false, true})
            for (const bool perspective : {false, true}) {
                const RendererWorld world = worldOfQuads(squaresAt(distance, brightFirst), 2);
                FrameSettings settings;
                settings.width = 48;
                settings.height = 32;
                settings.samplesPerPixel = 4;
                settings.camera.perspective = perspective;
                settings.camera.ymag = 0.5f * distance;
                settings.camera.znear = 0.01f;
                const Image image = Renderer(world.input(), kShaderFolder).render(settings);
                for (const glm::vec3& pixel : image.pixels)
                    ASSERT_NEAR(pixel.x, 0.25f, 1e-5f) << distance << ' ' << brightFirst << perspective;
            }
}

// Nothing is cut off before the near plane nor behind the farthest thing.
TEST(RendererDepth, AllOfTheSceneIsBetweenThePlanes) {
    const HeadlessContext context;
    for (const float znear : {1e-6f, 0.01f, 0.9f})
        for (const bool perspective : {false, true}) {
            const RendererWorld world = worldOfQuads(squaresAt(1, false), 2);
            FrameSettings settings;
            settings.width = settings.height = 16;
            settings.samplesPerPixel = 1;
            settings.camera.perspective = perspective;
            settings.camera.ymag = 0.5f;
            settings.camera.znear = znear;
            const Image image = Renderer(world.input(), kShaderFolder).render(settings);
            for (const glm::vec3& pixel : image.pixels) ASSERT_NEAR(pixel.x, 0.25f, 1e-5f) << znear;
            settings.camera.znear = 1.0005f;  // between the two
            const Image behind = Renderer(world.input(), kShaderFolder).render(settings);
            for (const glm::vec3& pixel : behind.pixels) ASSERT_NEAR(pixel.x, 5, 1e-4f);
        }
}

}  // namespace
}  // namespace phat::test
