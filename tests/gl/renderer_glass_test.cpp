// Glass as the renderer draws it: against formulas, and its shadows against the path tracer.

#include <gtest/gtest.h>

#include "core/render/path_tracer.h"
#include "core/scene/brdf.h"
#include "gl/renderer_world.h"
#include "support/glass_scenes.h"

namespace phat::test {
namespace {

// A furnace of radiance 1 for every surface of `scene`.
RendererWorld furnaceOf(const Scene& scene) {
    RendererWorld world = worldOfQuads(scene, 2);
    for (uint32_t surface = 0; surface < scene.surfaces.size(); ++surface)
        fillPhatexels(world, surface, [](glm::vec3, glm::vec3) { return glm::vec3(1); });
    for (uint32_t& e : world.phatexture.indirectIrradiance) e = packRgb9e5(glm::vec3(kPi));
    return world;
}

class RendererGlass : public ::testing::Test {
  protected:
    Image draw(const RendererWorld& world, const Camera& camera, Component component = Component::all) {
        Renderer renderer(world.input(), kShaderFolder);
        FrameSettings settings;
        settings.width = settings.height = 64;
        settings.camera = camera;
        settings.component = component;
        settings.samplesPerPixel = 1;
        return renderer.render(settings);
    }
    HeadlessContext context_;
};

void expectColor(glm::vec3 got, glm::vec3 want, float tolerance) {
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(got[c], want[c], tolerance) << c;
}

void addScreen(Scene& scene, const Material& material, float z) {
    addQuad(scene, material, {-1, -1, z}, {2, 0, 0}, {0, 2, 0});
}

Camera frontCamera(float degrees = 0) {
    const float angle = glm::radians(degrees);
    Camera camera = lookAtCamera({5 * std::sin(angle), 0, 5 * std::cos(angle)}, {0, 0, 0}, 40);
    camera.perspective = false;
    camera.ymag = 0.2f;
    return camera;
}

// Half of each pane's material is diffuse, half transmits; without an interface nothing else is reflected.
TEST_F(RendererGlass, PanesCoverEachOtherFarToNear) {
    Material red = glass(1), blue = glass(1);
    for (Material* m : {&red, &blue}) m->transmission = 0.5f;
    red.baseColor = {0.8f, 0.2f, 0.4f, 1};
    blue.baseColor = {0.1f, 0.4f, 0.9f, 1};
    const glm::vec3 near(red.baseColor), far(blue.baseColor);
    for (const bool nearFirst : {false, true}) {
        Scene scene;
        addScreen(scene, emitter({2, 2, 2}), -1);
        addScreen(scene, nearFirst ? red : blue, nearFirst ? 1.0f : 0.0f);
        addScreen(scene, nearFirst ? blue : red, nearFirst ? 0.0f : 1.0f);
        const glm::vec3 behind = 0.5f * far + 0.5f * far * 2.0f;
        // Irradiance and radiance are stored at 9 bits.
        expectColor(draw(furnaceOf(scene), frontCamera()).at(30, 30), 0.5f * near + 0.5f * near * behind,
                    0.006f);
    }
}

// What glass does not reflect it lets through: it cannot be seen in a furnace, a pane or a volume, from ahead
// or aside.
TEST_F(RendererGlass, CannotBeSeenInAFurnace) {
    for (const float degrees : {0.0f, 50.0f, 75.0f}) {
        for (const float roughness : {0.1f, 0.6f}) {
            Scene pane, slab;
            addScreen(pane, glass(1.5f, roughness), 0);
            addOutwardBox(slab, solidGlass(1.5f, roughness), {-1, -1, -0.01f}, {2, 2, 0.01f});
            for (Scene* scene : {&pane, &slab}) {
                addQuad(*scene, emitter({1, 1, 1}), {-9, -9, -1}, {18, 0, 0}, {0, 18, 0});
                const Image image = draw(furnaceOf(*scene), frontCamera(degrees));
                expectColor(image.at(30, 30), glm::vec3(1), 0.01f);
            }
        }
    }
}

TEST_F(RendererGlass, TintsByItsColourAndByBeersLaw) {
    Material material = solidGlass(1.5f, 0.1f);
    material.baseColor = {0.9f, 0.8f, 0.5f, 1};
    material.attenuationColor = {0.5f, 0.9f, 1};
    material.attenuationDistance = 0.2f;
    material.thickness = 0.1f;
    const float r = specularAlbedo(glm::vec3(0.04f), 1, 0.01f, 1).x;
    const glm::vec3 left = glm::pow(material.attenuationColor, glm::vec3(0.5f)), tint(material.baseColor);
    Scene pane, slab;
    addScreen(pane, material, 0);
    addOutwardBox(slab, material, {-1, -1, -0.1f}, {2, 2, 0.1f});
    // Half as thick in the units of meshes that their nodes make twice as large.
    for (Scene* scene : {&pane, &slab}) {
        scene->materials.back().thickness = 0.05f;
        for (Surface& surface : scene->surfaces) surface.metersPerUnit = 2;
        addScreen(*scene, emitter({1, 1, 1}), -1);
    }
    // Without light of their own they reflect nothing.
    expectColor(draw(worldOfQuads(pane, 2), frontCamera()).at(30, 30), (1 - r) * tint * left, 2e-3f);
    expectColor(draw(worldOfQuads(slab, 2), frontCamera()).at(30, 30),
                square(1 - r) * tint * tint * left / (1.0f - r * r * left * left), 2e-3f);
}

TEST_F(RendererGlass, CastsTheShadowOfItsTransmittance) {
    for (const float tint : {1.0f, 0.6f, 0.3f}) {
        for (const bool closed : {false, true}) {
            Material material = closed ? solidGlass() : glass();
            material.baseColor = {tint, 0.5f * tint, tint * tint, 1};
            Scene scene;
            addFloor(scene, lambert(1), 8);
            if (closed)
                addOutwardBox(scene, material, {-1, 1, -1}, {2, 0.01f, 2});
            else
                addFloor(scene, material, 2, 1);
            scene.lights.push_back(directionalLight(glm::vec3(kPi), {0, -1, 0}));
            const glm::vec3 color(material.baseColor);
            const float r = 0.04f;
            const glm::vec3 want = closed ? square(1 - r) * color * color : (1 - r) * color;
            const Camera camera = lookAtCamera({3, 0.8f, 0}, {0, 0, 0}, 5);
            expectColor(draw(worldOfQuads(scene, 2), camera).at(32, 32), want, 2e-3f);
            const RayScene rays(scene);
            const LightSampler lights(scene);
            PixelSample sample{Rng(1)};
            expectColor(pathTracer(rays, lights, Component::direct)(cameraRay(camera, 64, 64, {32.5f, 32.5f}),
                                                                    sample),
                        want, 3e-3f);
            // Above the glass there is no shadow.
            Scene above = scene;
            addFloor(above, lambert(1), 0.5f, 1.5f);
            EXPECT_NEAR(
                draw(worldOfQuads(above, 2), lookAtCamera({3, 2.3f, 0}, {0, 1.5f, 0}, 5)).at(32, 32).x, 1,
                2e-3f);
        }
    }
}

TEST_F(RendererGlass, AppearsAndDisappearsByAChangeOfMaterial) {
    Scene scene;
    addScreen(scene, emitter({1, 1, 1}), -1);
    addScreen(scene, lambert(0.5f), 0);
    const RendererWorld world = worldOfQuads(scene, 2);
    Renderer renderer(world.input(), kShaderFolder);
    FrameSettings settings;
    settings.width = settings.height = 64;
    settings.camera = frontCamera();
    const Image opaque = renderer.render(settings);
    expectColor(opaque.at(30, 30), glm::vec3(0), 1e-3f);
    std::vector<Material> materials = scene.materials;
    materials[1].transmission = 1;
    renderer.setMaterials(materials);
    expectColor(renderer.render(settings).at(30, 30), glm::vec3(0.5f), 1e-3f);
    renderer.setMaterials(scene.materials);
    EXPECT_EQ(renderer.render(settings).pixels, opaque.pixels);
}

}  // namespace
}  // namespace phat::test
