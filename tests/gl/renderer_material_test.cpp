// glTF's rendering rules: alpha, vertex colours, sRGB, sides, environment, components, tone of the whole.

#include <gtest/gtest.h>

#include "core/scene/lights.h"
#include "gl/gl_error.h"
#include "gl/renderer_world.h"

namespace phat::test {
namespace {

class RendererMaterial : public ::testing::Test {
  protected:
    Image draw(const Scene& scene, const Camera& camera, Component component = Component::all,
               int samples = 1) {
        const RendererWorld world = worldOfQuads(scene, 2);
        Renderer renderer(world.input(), kShaderFolder);
        FrameSettings settings;
        settings.width = settings.height = 64;
        settings.camera = camera;
        settings.component = component;
        settings.samplesPerPixel = samples;
        return renderer.render(settings);
    }
    HeadlessContext context_;
};

void expectColor(glm::vec3 got, glm::vec3 want, float tolerance = 1e-3f) {
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(got[c], want[c], tolerance * std::max(want[c], 1.0f));
}

// A quad of size 2 in the plane z, seen from +z; its u grows to the right and v downward, as in glTF.
void addScreen(Scene& scene, const Material& material, float z) {
    addQuad(scene, material, {-1, -1, z}, {2, 0, 0}, {0, 2, 0});
    for (size_t i = scene.uv0.size() - 6; i < scene.uv0.size(); ++i) scene.uv1[i].y = 1 - scene.uv0[i].y;
}

Camera frontCamera() {
    Camera camera = lookAtCamera({0, 0, 5}, {0, 0, 0}, 40);
    camera.perspective = false;
    camera.ymag = 1;
    return camera;
}

Material glow(glm::vec3 nit) {
    return emitter(nit);
}

TEST_F(RendererMaterial, BlendedSurfacesMixFarToNear) {
    for (bool nearFirst : {false, true}) {
        Scene scene;
        addScreen(scene, glow({1, 1, 1}), -1);
        Material red = glow({8, 0, 0}), green = glow({0, 4, 0});
        for (Material* m : {&red, &green}) m->alphaMode = AlphaMode::blend;
        red.baseColor.a = 0.5f;
        green.baseColor.a = 0.25f;
        addScreen(scene, nearFirst ? green : red, nearFirst ? 1.0f : 0.0f);
        addScreen(scene, nearFirst ? red : green, nearFirst ? 0.0f : 1.0f);
        const Image image = draw(scene, frontCamera());
        // Behind: white 1; red half over it; green a quarter over both.
        expectColor(image.at(30, 30), {0.75f * 4.5f, 0.75f * 0.5f + 1.0f, 0.75f * 0.5f});
    }
}

TEST_F(RendererMaterial, MaskCutsAtTheThreshold) {
    Scene scene;
    addScreen(scene, glow({1, 1, 1}), -1);
    Material mask = glow({4, 0, 0});
    mask.alphaMode = AlphaMode::mask;
    mask.alphaCutoff = 0.5f;
    mask.baseColorTexture.image = 0;
    mask.baseColorTexture.nearest = true;
    TextureImage image;
    image.width = 2;
    image.height = 1;
    image.texels = {{255, 255, 255, 120}, {255, 255, 255, 135}};
    scene.images.push_back(image);
    addScreen(scene, mask, 0);
    const Image picture = draw(scene, frontCamera());
    expectColor(picture.at(10, 20), {1, 1, 1});
    expectColor(picture.at(50, 20), {4, 0, 0});
}

TEST_F(RendererMaterial, SrgbIsDecodedAndRowZeroIsTheTop) {
    Scene scene;
    Material material = glow({1, 1, 1});
    material.emissionTexture.image = 0;
    material.emissionTexture.nearest = true;
    material.emissionTexture.uvSet = 1;
    const uint8_t grey[] = {188, 64, 0, 255};
    addGreyImage(scene, 2, 2, grey);
    addScreen(scene, material, 0);
    const Image image = draw(scene, frontCamera());
    expectColor(image.at(10, 10), glm::vec3(0.502886f));
    expectColor(image.at(50, 10), glm::vec3(0.051269f));
    expectColor(image.at(10, 50), glm::vec3(0));
    expectColor(image.at(50, 50), glm::vec3(1));
}

TEST_F(RendererMaterial, VertexColorsMultiplyTheBase) {
    Scene scene;
    Material material = lambert(1);
    material.baseColor = {0.8f, 0.6f, 0.4f, 1};
    addScreen(scene, material, 0);
    for (glm::vec4& color : scene.colors) color = {0.5f, 0.25f, 1, 1};
    scene.lights.push_back(directionalLight(glm::vec3(kPi), {0, 0, -1}));
    expectColor(draw(scene, frontCamera(), Component::direct).at(30, 30), {0.4f, 0.15f, 0.4f}, 5e-3f);
}

TEST_F(RendererMaterial, SingleSidedBacksAreNotDrawn) {
    Scene scene;
    addScreen(scene, glow({1, 1, 1}), -1);
    addQuad(scene, glow({5, 0, 0}), {-1, -1, 0}, {0, 2, 0}, {2, 0, 0});  // faces away
    expectColor(draw(scene, frontCamera()).at(30, 30), {1, 1, 1});
    scene.materials[1].doubleSided = true;
    expectColor(draw(scene, frontCamera()).at(30, 30), {5, 0, 0});
}

TEST_F(RendererMaterial, UnlitShowsItsColorAlone) {
    Scene scene;
    Material unlit;
    unlit.unlit = true;
    unlit.emission = {0.25f, 0.5f, 0.75f};
    addScreen(scene, unlit, 0);
    scene.lights.push_back(directionalLight(glm::vec3(10), {0, 0, -1}));
    expectColor(draw(scene, frontCamera()).at(30, 30), {0.25f, 0.5f, 0.75f});
}

// An edge at 45 degrees over the whole picture: the box filter gives the covered share.
TEST_F(RendererMaterial, EdgesAreBoxFiltered) {
    Scene scene;
    addQuad(scene, glow({1, 1, 1}), {-1, -1, 0}, {2, 0, 0}, {0.5f, 2, 0});
    Camera camera = frontCamera();
    const Image image = draw(scene, camera, Component::all, 64);
    // The left edge runs from (-1, -1) to (-.5, 1).
    for (int y = 2; y < 62; ++y) {
        for (int x = 0; x < 20; ++x) {
            double covered = 0;
            for (int i = 0; i < 1000; ++i) {
                const double py = 1 - (y + (i + 0.5) / 1000) / 32;
                const double edge = (-1 + 0.25 * (py + 1) + 1) * 32;
                covered += std::clamp(x + 1 - edge, 0.0, 1.0) / 1000;
            }
            ASSERT_NEAR(image.at(x, y).x, covered, 0.05)
                << x << ' ' << y;  // 64 points: discrepancy under .05
        }
    }
}

TEST_F(RendererMaterial, EnvironmentIsBehindEverythingTheRightWayRound) {
    Scene scene;
    addQuad(scene, lambert(0.5f), {100, 0, 0}, {0, 0, 1}, {1, 0, 0});
    Environment environment;
    environment.radiance = Image(16, 8);
    for (int y = 0; y < 8; ++y)
        for (int x = 0; x < 16; ++x) environment.radiance.at(x, y) = {0.1f * float(x), 0.2f * float(y), 1};
    scene.environment = environment;
    const LightSampler lights(scene);
    for (glm::vec3 toward : {glm::vec3(1, 0.3f, 0.2f), glm::vec3(0.1f, -0.5f, 1), glm::vec3(-1, 0.2f, 0.4f),
                             glm::vec3(0.3f, 0.6f, -1)}) {
        const Camera camera = lookAtCamera({0, 0, 0}, toward, 40);
        const Image image = draw(scene, camera);
        for (int y = 3; y < 64; y += 19) {
            for (int x = 3; x < 64; x += 19) {
                const glm::vec3 want = lights.environmentRadiance(pixelDirection(camera, x, y, 64, 64));
                // GPUs interpolate with 8-bit weights: 1.5 / 256 where the azimuth wraps.
                for (int c = 0; c < 3; ++c) EXPECT_NEAR(image.at(x, y)[c], want[c], 1e-2f);
            }
        }
    }
    expectColor(draw(scene, lookAtCamera({0, 0, 0}, {1, 0.3f, 0.2f}, 40), Component::indirect).at(30, 30),
                {0, 0, 0});
}

TEST_F(RendererMaterial, ComponentsAddUp) {
    Scene scene;
    Material material;
    material.baseColor = {0.7f, 0.5f, 0.3f, 1};
    material.metallic = 0.5f;
    material.roughness = 0.5f;
    material.emission = {0.1f, 0.2f, 0.3f};
    addFloor(scene, material, 2);
    scene.lights.push_back(pointLight(glm::vec3(2), {0.3f, 1, 0}));
    RendererWorld world = worldOfQuads(scene, 4);
    fillPhatexels(
        world, 0, [](glm::vec3 p, glm::vec3 d) { return glm::vec3(1 + d.x, 2 + p.x, 0.5f + d.y); }, 1.0f);
    for (uint32_t& e : world.phatexture.indirectIrradiance) e = packRgb9e5({3, 2, 1});
    Renderer renderer(world.input(), kShaderFolder);
    FrameSettings settings;
    settings.width = settings.height = 40;
    settings.samplesPerPixel = 2;
    settings.camera = lookAtCamera({0.5f, 0.9f, 0.9f}, {0, 0, 0}, 50);
    const auto render = [&](Component component) {
        settings.component = component;
        return renderer.render(settings);
    };
    const Image all = render(Component::all), direct = render(Component::direct);
    const Image indirect = render(Component::indirect), glossy = render(Component::glossyIndirect);
    const Image diffuse = render(Component::diffuseIndirect);
    for (size_t i = 0; i < all.pixels.size(); ++i) {
        for (int c = 0; c < 3; ++c) {
            ASSERT_NEAR(all.pixels[i][c], direct.pixels[i][c] + indirect.pixels[i][c],
                        1e-5f * all.pixels[i][c]);
            ASSERT_NEAR(indirect.pixels[i][c], glossy.pixels[i][c] + diffuse.pixels[i][c],
                        1e-5f * all.pixels[i][c]);
        }
    }
    const glm::vec3 middle = glossy.at(20, 20);
    EXPECT_GT(middle.x, 0.01f);
    EXPECT_GT(diffuse.at(20, 20).x, 0.01f);
    EXPECT_GT(direct.at(20, 20).z, 0.3f);
}

// A square seen straight on stays square in a picture of another shape than the camera's.
TEST_F(RendererMaterial, PictureShapeDoesNotStretch) {
    Scene scene;
    Material glow = lambert(0);
    glow.emission = glm::vec3(1);
    addScreen(scene, glow, 0);
    const RendererWorld world = worldOfQuads(scene, 2);
    Renderer renderer(world.input(), kShaderFolder);
    FrameSettings settings;
    settings.camera = lookAtCamera({0, 0, 4}, {0, 0, 0}, 60);
    settings.camera.aspect = 1.5f;
    settings.samplesPerPixel = 1;
    settings.height = 64;
    for (int width : {64, 96, 160}) {
        settings.width = width;
        const Image image = renderer.render(settings);
        int across = 0, down = 0;
        for (int x = 0; x < width; ++x) across += image.at(x, 32).x > 0.5f;
        for (int y = 0; y < 64; ++y) down += image.at(width / 2, y).x > 0.5f;
        EXPECT_NEAR(across, 64 * 2 / (8 * std::tan(glm::radians(30.0f))), 1.0f);
        EXPECT_EQ(across, down);
    }
}

TEST_F(RendererMaterial, MissingShadersAreOneSentence) {
    Scene scene;
    addScreen(scene, lambert(0.5f), 0);
    const RendererWorld world = worldOfQuads(scene, 2);
    EXPECT_THROW(Renderer(world.input(), "no/such/folder"), GlError);
}

}  // namespace
}  // namespace phat::test
