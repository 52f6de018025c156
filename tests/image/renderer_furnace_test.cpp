// Constant radiance everywhere: the ratio estimator must return the lobe's albedo times it, whatever the guides.

#include <gtest/gtest.h>

#include "core/brdf.h"
#include "image/renderer_world.h"

namespace phat::test {
namespace {

class RendererFurnace : public ::testing::Test {
  protected:
    HeadlessContext context_;
};

Material metal(float roughness) {
    Material material;
    material.baseColor = {0.9f, 0.6f, 0.3f, 1};
    material.metallic = 1;
    material.roughness = roughness;
    return material;
}

RendererWorld furnaceFloor(const Material& material, glm::vec3 radiance) {
    Scene scene;
    addFloor(scene, material, 2);
    RendererWorld world = worldOfQuads(scene, 8);
    fillPhatexels(world, 0, [&](glm::vec3, glm::vec3) { return radiance; });
    world.irradiance.assign(world.irradiance.size(), kPi * radiance);
    return world;
}

// The pixels' cosine varies over the picture; the expectation follows it.
void expectPicture(const Image& image, const Camera& camera, const std::function<glm::vec3(float)>& expected,
                   float relative) {
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            const glm::vec3 direction = pixelDirection(camera, x, y, image.width, image.height);
            const glm::vec3 want = expected(-direction.y);
            for (int c = 0; c < 3; ++c)
                ASSERT_NEAR(image.at(x, y)[c], want[c], relative * want[c]) << "pixel " << x << ' ' << y;
        }
    }
}

FrameSettings frame(const Camera& camera, Component component) {
    FrameSettings settings;
    settings.width = 48;
    settings.height = 32;
    settings.camera = camera;
    settings.component = component;
    settings.samplesPerPixel = 1;
    return settings;
}

TEST_F(RendererFurnace, MetalReflectsItsAlbedo) {
    const glm::vec3 radiance(1.5f, 0.75f, 3.0f);  // exact in RGB9E5
    const Camera camera = lookAtCamera({0, 0.6f, 0.7f}, {0, 0, 0}, 40);
    for (float roughness : {0.1f, 0.3f, 0.6f, 1.0f}) {
        const RendererWorld world = furnaceFloor(metal(roughness), radiance);
        Renderer renderer(world.input(), kShaderFolder);
        const Image image = renderer.render(frame(camera, Component::glossyIndirect));
        const glm::vec3 f0(world.scene.materials[0].baseColor);
        // Float rounding of the sums, and of the two table lookups.
        expectPicture(image, camera, [&](float nDotV) {
            return radiance * specularAlbedo(f0, 1, roughness * roughness, nDotV);
        }, 2e-3f);
    }
}

}  // namespace
}  // namespace phat::test
