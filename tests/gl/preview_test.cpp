// The first picture, which waits for small programs alone.

#include <gtest/gtest.h>

#include <glm/gtc/constants.hpp>

#include "core/phatexel/phatexture.h"
#include "gl/picture_sum.h"
#include "gl/renderer_world.h"
#include "gl/shader_loader.h"

namespace phat::test {
namespace {

// A coated metal floor that receives the same light everywhere.
RendererWorld coatedFloor(glm::vec3 irradiance) {
    Scene scene;
    Material coated = metal(0.4f);
    coated.clearcoat = 1;
    addQuad(scene, coated, {-1, 0, 1}, {2, 0, 0}, {0, 0, -2});
    RendererWorld world = worldOfQuads(std::move(scene), 8);
    fillPhatexels(world, 0, [](glm::vec3, glm::vec3) { return glm::vec3(0.5f); });
    world.phatexture.indirectIrradiance.assign(world.atlas.texelCount(), packRgb9e5(irradiance));
    return world;
}

FrameSettings aboveTheFloor() {
    FrameSettings settings;
    settings.width = settings.height = 16;
    settings.camera = lookAtCamera({0, 2, 0}, {0, 0, 0}, 20);
    settings.samplesPerPixel = 4;
    settings.mayPreview = true;
    return settings;
}

// Draws until the picture is no preview. Returns how many were.
int drawWhole(Renderer& renderer, const FrameSettings& settings, PictureSum& sum) {
    int previews = 0;
    for (renderer.draw(settings, sum); sum.preview; renderer.draw(settings, sum)) ++previews;
    return previews;
}

TEST(Preview, IsTheFirstPictureAlone) {
    const HeadlessContext context;
    const glm::vec3 irradiance(2, 1, 0.5f);
    const RendererWorld world = coatedFloor(irradiance);
    Renderer renderer(world.input(), kShaderFolder);
    const FrameSettings settings = aboveTheFloor();
    PictureSum sum;
    renderer.draw(settings, sum);
    ASSERT_TRUE(sum.preview);
    EXPECT_EQ(sum.samples, 1);
    const glm::vec3 color(metal(0.4f).baseColor);
    const Image preview = readMean(sum);
    for (const glm::vec3& pixel : preview.pixels)
        for (int channel = 0; channel < 3; ++channel)
            // The irradiance has nine bits.
            ASSERT_NEAR(pixel[channel], color[channel] * irradiance[channel] / glm::pi<float>(), 2e-3f);

    drawWhole(renderer, settings, sum);
    EXPECT_EQ(sum.samples, settings.samplesPerPixel);
    FrameSettings waiting = settings;
    waiting.mayPreview = false;
    const Image whole = Renderer(world.input(), kShaderFolder).render(waiting);
    EXPECT_EQ(readMean(sum).pixels, whole.pixels);
    EXPECT_GT(std::abs(whole.at(8, 8).x - preview.at(8, 8).x), 0.05f);
    // Nor is one of another view a preview.
    FrameSettings other = settings;
    other.camera = lookAtCamera({0, 2, 1}, {0, 0, 0}, 20);
    renderer.draw(other, sum);
    EXPECT_FALSE(sum.preview);
}

// Programs that are needed from some time on: a preview for as long as the driver compiles them in the
// background, or none.
TEST(Preview, GivesWayToWhatNewMaterialsNeed) {
    const HeadlessContext context;
    RendererWorld world = coatedFloor(glm::vec3(1));
    world.scene.materials[0].clearcoat = 0;
    Renderer renderer(world.input(), kShaderFolder);
    FrameSettings settings = aboveTheFloor();
    PictureSum sum;
    EXPECT_GE(drawWhole(renderer, settings, sum), 1);
    std::vector<Material> coated = world.scene.materials;
    coated[0].clearcoat = 1;
    renderer.setMaterials(coated);
    const int previews = drawWhole(renderer, settings, sum);
    if (!compilesInBackground()) {
        EXPECT_EQ(previews, 0);
    }
    const RendererWorld same = coatedFloor(glm::vec3(1));
    settings.mayPreview = false;
    EXPECT_EQ(readMean(sum).pixels, Renderer(same.input(), kShaderFolder).render(settings).pixels);
}

// A picture that is waited for is whole at once.
TEST(Preview, IsNotWhatARenderIs) {
    const HeadlessContext context;
    const RendererWorld world = coatedFloor(glm::vec3(1));
    Renderer renderer(world.input(), kShaderFolder);
    FrameSettings settings = aboveTheFloor();
    settings.mayPreview = false;
    PictureSum sum;
    renderer.draw(settings, sum);
    EXPECT_FALSE(sum.preview);
    EXPECT_EQ(sum.samples, settings.samplesPerPixel);
}

}  // namespace
}  // namespace phat::test
