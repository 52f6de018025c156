// Constant radiance everywhere: the ratio estimator must return the lobe's albedo times it, whatever the
// guides.

#include <gtest/gtest.h>

#include "core/scene/brdf.h"
#include "gl/renderer_world.h"

namespace phat::test {
namespace {

class RendererFurnace : public ::testing::Test {
  protected:
    HeadlessContext context_;
};

RendererWorld furnaceFloor(const Material& material, glm::vec3 radiance) {
    Scene scene;
    addFloor(scene, material, 2);
    RendererWorld world = worldOfQuads(scene, 8);
    fillPhatexels(world, 0, [&](glm::vec3, glm::vec3) { return radiance; });
    world.phatexture.indirectIrradiance.assign(world.atlas.texelCount(), packRgb9e5(kPi * radiance));
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
        expectPicture(
            image, camera,
            [&](float nDotV) { return radiance * specularAlbedo(f0, 1, roughness * roughness, nDotV); },
            2e-3f);
    }
}

TEST_F(RendererFurnace, LambertReflectsIrradianceOverPi) {
    const glm::vec3 radiance(1.5f, 0.75f, 3.0f);
    const Camera camera = lookAtCamera({0, 0.6f, 0.7f}, {0, 0, 0}, 40);
    const RendererWorld world = furnaceFloor(lambert(0.5f), radiance);
    Renderer renderer(world.input(), kShaderFolder);
    const Image diffuse = renderer.render(frame(camera, Component::diffuseIndirect));
    // The file's RGB9E5 holds 9 bits of the largest channel, half floats 11. What rounding puts above the
    // brightest PHATexel is cut.
    const glm::vec3 stored = glm::min(unpackRgb9e5(packRgb9e5(kPi * radiance)), kPi * radiance);
    expectPicture(
        diffuse, camera, [&](float) { return 0.5f * stored / kPi; }, 1e-3f);
}

TEST_F(RendererFurnace, InvalidTexelsDropOut) {
    const glm::vec3 radiance(1.5f, 0.75f, 3.0f);
    const Camera camera = lookAtCamera({0, 0.6f, 0.7f}, {0, 0, 0}, 40);
    RendererWorld world = furnaceFloor(metal(0.3f), radiance);
    Rng random(9);
    for (PackedPhatexel& texel : world.phatexture.indirect[0].texels)
        if (random.uniform() < 0.7f) texel = {};
    Renderer renderer(world.input(), kShaderFolder);
    const Image image = renderer.render(frame(camera, Component::glossyIndirect));
    const glm::vec3 f0(world.scene.materials[0].baseColor);
    expectPicture(
        image, camera, [&](float nDotV) { return radiance * specularAlbedo(f0, 1, 0.09f, nDotV); }, 2e-3f);
}

// Moves the indirect PHATexels to the area lights.
RendererWorld areaFloor(const Material& material, const LightAt& light, uint32_t tiles = 8) {
    Scene scene;
    addFloor(scene, material, 2);
    RendererWorld world = worldOfQuads(scene, tiles);
    fillPhatexels(world, 0, light);
    world.phatexture.area = world.phatexture.indirect;
    world.phatexture.areaGuides = world.phatexture.indirectGuides;
    for (PackedPhatexel& texel : world.phatexture.indirect[0].texels) texel.radiance = 0;
    world.phatexture.areaIrradiance.assign(world.atlas.texelCount(), 0);
    return world;
}

// Area lights all around are weighed by their own samples: as exact as indirect light.
TEST_F(RendererFurnace, SurroundingAreaLightReflectsTheAlbedo) {
    const glm::vec3 radiance(1.5f, 0.75f, 3.0f);
    const Camera camera = lookAtCamera({0, 0.6f, 0.7f}, {0, 0, 0}, 40);
    const RendererWorld world = areaFloor(metal(0.3f), [&](glm::vec3, glm::vec3) { return radiance; });
    Renderer renderer(world.input(), kShaderFolder);
    const glm::vec3 f0(world.scene.materials[0].baseColor);
    expectPicture(
        renderer.render(frame(camera, Component::all)), camera,
        [&](float nDotV) { return radiance * specularAlbedo(f0, 1, 0.09f, nDotV); }, 2e-3f);
}

// Of unit radiance from the directions about the normal whose cosine is above `cosine`: the part that is
// reflected. Midpoint rule, equal areas.
glm::dvec3 reflectedOfCap(const Brdf& brdf, glm::vec3 towardEye, float cosine) {
    constexpr int kSteps = 64;
    const float cellSteradians = 2 * kPi * (1 - cosine) / float(kSteps * kSteps);
    glm::dvec3 sum(0);
    for (int i = 0; i < kSteps * kSteps; ++i) {
        const float z = 1 - (1 - cosine) * (float(i / kSteps) + 0.5f) / kSteps;
        const float phi = 2 * kPi * (float(i % kSteps) + 0.5f) / kSteps;
        const float r = std::sqrt(1 - z * z);
        sum += cellSteradians * evaluateBrdf(brdf, towardEye, {r * std::cos(phi), r * std::sin(phi), z});
    }
    return sum;
}

Brdf metalBrdf(const RendererWorld& world, float alpha) {
    return {
        .diffuseColor = glm::vec3(0), .f0 = glm::vec3(world.scene.materials[0].baseColor), .alpha = alpha};
}

// A small lamp is weighed by the expectation; the picture's mean is the integral over the lamp.
TEST_F(RendererFurnace, SmallLampHasItsEnergy) {
    const float cosine = 0.94f;  // the lamp's cap about the zenith: 6 % of the hemisphere
    const LightAt lamp = [&](glm::vec3, glm::vec3 direction) {
        return glm::vec3(direction.y > cosine ? 4.0f : 0.0f);
    };
    const RendererWorld world = areaFloor(metal(0.6f), lamp, 64);
    const Camera camera = lookAtCamera({0, 3, 0.6f}, {0, 0, 0}, 20);
    Renderer renderer(world.input(), kShaderFolder);
    const Image image = renderer.render(frame(camera, Component::direct));

    const Brdf brdf = metalBrdf(world, 0.36f);
    glm::dvec3 got(0), want(0);
    for (int y = 0; y < image.height; y += 4) {
        for (int x = 0; x < image.width; x += 4) {
            const glm::vec3 d = -pixelDirection(camera, x, y, image.width, image.height);
            want += 4.0 * reflectedOfCap(brdf, {d.x, -d.z, d.y}, cosine);
            got += image.at(x, y);
        }
    }
    // Some 15,700 of the 262,144 PHATexels see the lamp: their number has a standard error of 0.8 %; three of
    // them.
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(got[c], want[c], 0.024 * want[c]);
}

// Few PHATexels see a small bright surface, and the pixels around share them: the blotches of a rough lobe
// are those of the irradiance by the same PHATexels, and that is known.
TEST_F(RendererFurnace, RoughLobesHaveTheNoiseOfTheIrradiance) {
    const float cosine = 0.96f, bright = 6, dark = 0.2f;  // 4 % of the hemisphere
    const float irradiance = kPi * (dark + (bright - dark) * (1 - cosine * cosine));
    const Camera camera = lookAtCamera({0, 0.6f, 0.7f}, {0, 0, 0}, 40);
    for (const float roughness : {0.9f, 1.0f}) {
        RendererWorld world = furnaceFloor(metal(roughness), glm::vec3(irradiance / kPi));
        world.phatexture.indirect[0] = layerInBakedOrder(world, [&](glm::vec3, glm::vec3 direction) {
            return glm::vec3(direction.y > cosine ? bright : dark);
        });
        prepareLookup(world);
        Renderer renderer(world.input(), kShaderFolder);
        const Image image = renderer.render(frame(camera, Component::glossyIndirect));
        const Brdf brdf = metalBrdf(world, roughness * roughness);
        double squares = 0, count = 0;
        for (int y = 0; y < image.height; y += 2)
            for (int x = 0; x < image.width; x += 2) {
                const glm::vec3 d = -pixelDirection(camera, x, y, image.width, image.height);
                const double want = (bright - dark) * reflectedOfCap(brdf, {d.x, -d.z, d.y}, cosine).x +
                                    dark * specularAlbedo(brdf.f0, 1, brdf.alpha, d.y).x;
                squares += square(image.at(x, y).x / want - 1);
                count += 1;
            }
        // .25 and .14 by the samples of the lobe alone.
        EXPECT_LT(std::sqrt(squares / count), 0.06) << roughness;
    }
}

// Together the two kinds of light cannot exceed the only radiance there is, whatever their noise.
TEST_F(RendererFurnace, NothingExceedsTheBrightestLight) {
    RendererWorld world = areaFloor(metal(0.2f), [](glm::vec3 p, glm::vec3 d) {
        return glm::vec3(std::sin(9 * p.x) + d.x > 0 ? 1.0f : 0.0f);
    });
    fillPhatexels(world, 0, [](glm::vec3 p, glm::vec3 d) {
        return glm::vec3(std::sin(9 * p.x) + d.x > 0 ? 0.0f : 1.0f);
    });
    Renderer renderer(world.input(), kShaderFolder);
    const Camera camera = lookAtCamera({0, 0.6f, 0.7f}, {0, 0, 0}, 40);
    const Image image = renderer.render(frame(camera, Component::all));
    const glm::vec3 f0(world.scene.materials[0].baseColor);
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            const float nDotV = -pixelDirection(camera, x, y, image.width, image.height).y;
            const glm::vec3 albedo = specularAlbedo(f0, 1, 0.04f, nDotV);
            for (int c = 0; c < 3; ++c) ASSERT_LE(image.at(x, y)[c], albedo[c] * 1.002f);
        }
    }
}

// The neighbour in the atlas is a thousand times brighter; nothing of it may be seen.
TEST_F(RendererFurnace, ChartsDoNotBleed) {
    Scene scene;
    addFloor(scene, metal(0.4f), 2);
    addFloor(scene, metal(0.4f), 2, -10);
    RendererWorld world = worldOfQuads(scene, 4);
    const glm::vec3 dim(1), bright(1024);
    fillPhatexels(world, 0, [&](glm::vec3, glm::vec3) { return dim; });
    fillPhatexels(world, 1, [&](glm::vec3, glm::vec3) { return bright; });
    for (uint32_t y = 0; y < world.atlas.sizeTexels.y; ++y)
        for (uint32_t x = 0; x < world.atlas.sizeTexels.x; ++x)
            world.phatexture.indirectIrradiance[size_t(y) * world.atlas.sizeTexels.x + x] =
                packRgb9e5(kPi * (world.atlas.chartAt({x, y}) == 0 ? dim : bright));
    Renderer renderer(world.input(), kShaderFolder);
    // Close to the edge that borders the other chart: x grows with the surface's across direction.
    for (glm::vec3 target : {glm::vec3(0.9f, 0, 0), glm::vec3(0, 0, 0.9f), glm::vec3(-0.9f, 0, 0)}) {
        Camera camera = lookAtCamera(target + glm::vec3(0, 0.25f, 0.02f), target, 20);
        const Image image = renderer.render(frame(camera, Component::glossyIndirect));
        const glm::vec3 f0(world.scene.materials[0].baseColor);
        expectPicture(
            image, camera, [&](float nDotV) { return specularAlbedo(f0, 1, 0.16f, nDotV); }, 2e-3f);
    }
}

TEST_F(RendererFurnace, MaterialsCanChangeBetweenFrames) {
    const Camera camera = lookAtCamera({0, 0.6f, 0.7f}, {0, 0, 0}, 40);
    const RendererWorld world = furnaceFloor(metal(0.3f), glm::vec3(2));
    Renderer renderer(world.input(), kShaderFolder);
    renderer.render(frame(camera, Component::glossyIndirect));
    std::vector<Material> materials = world.scene.materials;
    materials[0].roughness = 0.7f;
    materials[0].baseColor = {0.2f, 0.8f, 0.5f, 1};
    renderer.setMaterials(materials);
    const Image image = renderer.render(frame(camera, Component::glossyIndirect));
    expectPicture(
        image, camera,
        [&](float nDotV) {
            return 2.0f * specularAlbedo({0.2f, 0.8f, 0.5f}, 1, 0.49f, nDotV);
        },
        2e-3f);
}

}  // namespace
}  // namespace phat::test
