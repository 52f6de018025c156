// Punctual lights and their shadows against the CPU's exact answer, pixel by pixel.

#include <gtest/gtest.h>

#include "core/scene/brdf.h"
#include "core/scene/lights.h"
#include "core/scene/rays.h"
#include "core/scene/shading.h"
#include "gl/renderer_world.h"
#include "support/penumbra.h"
#include "support/photometries.h"

namespace phat::test {
namespace {

class RendererLight : public ::testing::Test {
  protected:
    HeadlessContext context_;
};

FrameSettings frame(const Camera& camera) {
    FrameSettings settings;
    settings.width = 96;
    settings.height = 72;
    settings.camera = camera;
    settings.component = Component::direct;
    settings.samplesPerPixel = 1;
    return settings;
}

constexpr uint8_t kAllLamps = 255;

// What a pixel's centre sees of the lamps; `lit` has a bit for each lamp that reaches it, `surface` says what
// it is on.
glm::vec3 directLight(const RayScene& rays, const LightSampler& lights, glm::vec3 eye, glm::vec3 direction,
                      uint8_t& lit, uint32_t& surface) {
    lit = kAllLamps;
    surface = 0;
    const Hit hit = rays.closestHit(eye, direction);
    if (!hit) return glm::vec3(0);
    surface = 1 + rays.scene().triangleSurface[hit.triangle];
    const SurfacePoint at = surfaceAt(rays.scene(), hit, direction);
    glm::vec3 sum = at.emission;
    for (size_t i = 0; i < rays.scene().lights.size(); ++i) {
        const LightSample light = lights.samplePunctual(i, at.position);
        const glm::vec3 value =
            evaluateBrdf(at.brdf, at.shading.toLocal(-direction), at.shading.toLocal(light.towardLight));
        if (rays.anyHit(rays.offsetOrigin(at.position, at.normalGeometric), light.towardLight,
                        light.distance))
            lit &= uint8_t(~(1u << i));
        else
            sum += value * light.radiance;
    }
    return sum;
}

void comparePictures(const RendererWorld& world, const Camera& camera, int minShadowPixels) {
    Renderer renderer(world.input(), kShaderFolder);
    const FrameSettings settings = frame(camera);
    const Image image = renderer.render(settings);
    const RayScene rays(world.scene);
    const LightSampler lights(world.scene);
    const glm::vec3 eye(camera.worldFromCamera[3]);

    Image want(image.width, image.height);
    std::vector<uint8_t> lit(want.pixels.size());
    std::vector<uint32_t> surface(want.pixels.size());
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            const size_t pixel = size_t(y) * image.width + x;
            want.at(x, y) =
                directLight(rays, lights, eye, pixelDirection(camera, x, y, image.width, image.height),
                            lit[pixel], surface[pixel]);
        }
    }
    int shadowPixels = 0, compared = 0;
    for (int y = 1; y < image.height - 1; ++y) {
        for (int x = 1; x < image.width - 1; ++x) {
            // A pixel beside a shadow's or an object's edge may fall to either side of it.
            bool edge = false;
            for (int dy = -1; dy <= 1; ++dy)
                for (int dx = -1; dx <= 1; ++dx) {
                    const size_t near = size_t(y + dy) * image.width + x + dx;
                    edge |= lit[near] != lit[size_t(y) * image.width + x];
                    edge |= surface[near] != surface[size_t(y) * image.width + x];
                }
            if (edge) continue;
            ++compared;
            shadowPixels += lit[size_t(y) * image.width + x] != kAllLamps;
            for (int c = 0; c < 3; ++c)
                ASSERT_NEAR(image.at(x, y)[c], want.at(x, y)[c], 2e-3f * want.at(x, y)[c] + 1e-5f)
                    << "pixel " << x << ' ' << y;
        }
    }
    EXPECT_GE(compared, image.width * image.height / 2);
    EXPECT_GE(shadowPixels, minShadowPixels);
}

Material plastic(float roughness) {
    Material material;
    material.baseColor = {0.6f, 0.5f, 0.2f, 1};
    material.metallic = 0;
    material.roughness = roughness;
    return material;
}

Scene floorAndShelf(float roughness) {
    Scene scene;
    addFloor(scene, plastic(roughness), 4);
    addFloor(scene, plastic(roughness), 0.8f, 0.4f);
    scene.materials.back().doubleSided = true;
    return scene;
}

TEST_F(RendererLight, PointLightAndShadow) {
    Scene scene = floorAndShelf(0.4f);
    scene.lights.push_back(pointLight({3, 4, 5}, {0.3f, 1.5f, 0.2f}));
    comparePictures(worldOfQuads(scene, 2), lookAtCamera({1.5f, 2, 2.5f}, {0, 0, 0}, 50), 100);
}

TEST_F(RendererLight, PointLightWithRange) {
    Scene scene = floorAndShelf(0.7f);
    scene.lights.push_back(pointLight({3, 4, 5}, {-0.6f, 1.2f, 0.2f}));
    scene.lights.back().rangeMeters = 2.5f;
    comparePictures(worldOfQuads(scene, 2), lookAtCamera({1.5f, 2, 2.5f}, {0, 0, 0}, 50), 100);
}

TEST_F(RendererLight, SpotLightNarrowAndWide) {
    for (float outer : {35.0f, 80.0f}) {
        Scene scene = floorAndShelf(0.5f);
        scene.lights.push_back(spotLight({8, 4, 5}, {0.8f, 1.5f, 0.2f},
                                         glm::normalize(glm::vec3(-0.5f, -1, 0)), 0.6f * outer, outer));
        comparePictures(worldOfQuads(scene, 2), lookAtCamera({1.5f, 2, 2.5f}, {0, 0, 0}, 50), 60);
    }
}

// Lamps all around and within a cone, two of the same photometry, one tilted and turned, beside a light
// without.
TEST_F(RendererLight, Photometry) {
    const std::vector<PhotometricFormula> formulas = photometricFormulas();
    const SharedValue<Photometry> washer = photometryOf(formulas[3]);
    for (const size_t other : {size_t(0), size_t(1), size_t(2), size_t(4)}) {
        Scene scene = floorAndShelf(0.5f);
        scene.lights = {photometricLight(washer, {8, 4, 5}, {0.8f, 1.5f, 0.2f}),
                        pointLight(glm::vec3(0.3f), {-1, 1, 1}),
                        photometricLight(photometryOf(formulas[other]), {1, 4, 2}, {-0.3f, 1.4f, -0.2f}),
                        photometricLight(washer, {2, 2, 6}, {0.2f, 1.1f, 0.9f})};
        const Frame tilted =
            frameFromNormalAndTangent(-glm::normalize(glm::vec3(0.3f, -1, -0.4f)), {1, 0, 2});
        scene.lights[3].direction = -tilted.normal, scene.lights[3].horizontalZero = tilted.tangent;
        comparePictures(worldOfQuads(scene, 2), lookAtCamera({1.5f, 2, 2.5f}, {0, 0, 0}, 50), 60);
    }
}

// A lamp that is dark beyond 40 degrees has one shadow map, which must reach as far.
TEST_F(RendererLight, PhotometryOfANarrowCone) {
    PhotometricWeb web{"cone", 1, 36, 1, std::vector<float>(37, 0.0f)};
    for (int v = 0; v < 8; ++v) web.relative[size_t(v)] = 1 - 0.1f * float(v);
    Scene scene = floorAndShelf(0.5f);
    scene.lights = {photometricLight(Photometry(web), {8, 4, 5}, {0.7f, 1.6f, 0.2f})};
    comparePictures(worldOfQuads(scene, 2), lookAtCamera({1.5f, 2, 2.5f}, {0, 0, 0}, 50), 60);
}

TEST_F(RendererLight, DirectionalLight) {
    Scene scene = floorAndShelf(0.5f);
    scene.lights.push_back(directionalLight({3, 3, 2}, glm::normalize(glm::vec3(0.4f, -1, 0.1f))));
    comparePictures(worldOfQuads(scene, 2), lookAtCamera({1.5f, 2, 2.5f}, {0, 0, 0}, 50), 100);
}

// In the middle row of a picture of the floor, by the closed form. An edge in the map is off by up to half a
// texel, of which the disc's shadow has eight in its radius.
TEST_F(RendererLight, PenumbraOfADiscBehindAStraightEdge) {
    constexpr float kRadius = 0.00465f, kShadowRadius = kRadius * kEdgeHeight;
    RendererWorld world = worldOfQuads(floorBehindEdge(kRadius), 2);
    Renderer renderer(world.input(), kShaderFolder);
    const Camera camera = lookAtCamera({0, 1, 0}, {0, 0, 0}, 7);
    const FrameSettings settings = frame(camera);
    const Image soft = renderer.render(settings);
    world.scene.lights[0].angularRadius = 0;
    renderer.setLights(world.scene.lights);
    const Image hard = renderer.render(settings);
    constexpr double kTexelError = 0.5 / 8 * 2 / 3.14159265358979;  // by the slope of the profile's middle
    int between = 0, hardBetween = 0;
    const int y = soft.height / 2;
    for (int x = 0; x < soft.width; ++x) {
        const glm::vec3 ray = pixelDirection(camera, x, y, soft.width, soft.height);
        const double offset = double(ray.x / -ray.y / kShadowRadius);
        const double seen = double(kPi * soft.at(x, y).x), sharp = double(kPi * hard.at(x, y).x);
        EXPECT_NEAR(seen, discFraction(offset), kTexelError) << "pixel " << x;
        between += seen > 0.02 && seen < 0.98;
        hardBetween += sharp > 0.02 && sharp < 0.98;
        if (std::abs(offset) > 0.3) {
            EXPECT_NEAR(sharp, offset > 0 ? 1 : 0, 1e-4);
        }
    }
    EXPECT_GT(between, 40);
    EXPECT_LT(hardBetween, 20);
    world.scene.lights[0].angularRadius = kRadius;
    renderer.setLights(world.scene.lights);
    EXPECT_EQ(renderer.render(settings).pixels, soft.pixels) << "the disc is back";
}

/// A metal that reflects all, under a disc at 45 degrees of an irradiance of 1 on what faces it; what a
/// camera sees of it around the mirrored disc. `halfAngle`: of the picture's height, radians.
Image mirroredDisc(float roughness, float radius, float halfAngle) {
    Scene scene;
    Material white;
    white.roughness = roughness;
    addFloor(scene, white, 8);
    scene.lights.push_back(directionalLight({1, 1, 1}, glm::normalize(glm::vec3(1, -1, 0))));
    scene.lights[0].angularRadius = radius;
    const RendererWorld world = worldOfQuads(std::move(scene), 2);
    Renderer renderer(world.input(), kShaderFolder);
    return renderer.render(frame(lookAtCamera({1, 1, 0}, {0, 0, 0}, glm::degrees(2 * halfAngle))));
}

constexpr float kSunRadius = 0.00465f;
// Of a lobe at 45 degrees around the mirror direction, of equal area.
float lobeWidth(float roughness) {
    return 2 * std::max(square(roughness), kMinAlpha) * std::sqrt(std::sqrt(0.5f));
}

// Whatever the lobe's width, all that arrives is reflected: the integral of the highlight over the directions
// to the eye is the irradiance. The picture holds ten widths, and a lobe has 1 % of its light beyond.
TEST_F(RendererLight, HighlightsOfADiscHaveAllItsLight) {
    for (const float roughness : {0.0f, 0.04f, 0.06f, 0.08f, 0.1f, 0.2f}) {
        const float halfAngle = 10 * std::max(lobeWidth(roughness), kSunRadius);
        const Image image = mirroredDisc(roughness, kSunRadius, halfAngle);
        const double side = 2 * std::tan(double(halfAngle)) / image.height;
        double sum = 0;
        for (int y = 0; y < image.height; ++y)
            for (int x = 0; x < image.width; ++x) {
                const double u = (x + 0.5 - image.width / 2.0) * side,
                             v = (y + 0.5 - image.height / 2.0) * side;
                sum += double(image.at(x, y).x) * side * side / std::pow(1 + u * u + v * v, 1.5);
            }
        EXPECT_NEAR(sum, 0.99, 0.03) << roughness;
    }
}

// A mirror shows the disc: its size, and its radiance but for the lobe's tails, a^2 / (a^2 + r^2) in the
// middle.
TEST_F(RendererLight, MirrorsShowADisc) {
    const float halfAngle = 2 * kSunRadius, width = lobeWidth(0);
    const Image image = mirroredDisc(0, kSunRadius, halfAngle);
    const float radiance = 1 / (kPi * square(kSunRadius));
    const float middle = radiance * square(kSunRadius) / (square(kSunRadius) + square(width));
    EXPECT_NEAR(image.at(image.width / 2, image.height / 2).x, middle, 0.02f * middle);
    int bright = 0;
    for (const glm::vec3& pixel : image.pixels) bright += pixel.x > 0.5f * middle;
    const float pixelsInRadius = 0.25f * float(image.height);
    EXPECT_NEAR(float(bright), kPi * square(pixelsInRadius), 0.08f * kPi * square(pixelsInRadius));
}

// As large as a shadow's filter or smaller, where the caster stands on the floor.
TEST_F(RendererLight, ADiscsShadowTouchesItsCaster) {
    Scene scene;
    addFloor(scene, lambert(0.8f), 4);
    addQuad(scene, lambert(0.5f), {0, 0, -1}, {0, 1, 0}, {0, 0, 2});
    scene.materials.back().doubleSided = true;
    scene.lights.push_back(directionalLight(glm::vec3(10), glm::normalize(glm::vec3(1, -1, 0))));
    scene.lights.back().angularRadius = 0.00465f;
    comparePictures(worldOfQuads(scene, 2), lookAtCamera({0.5f, 0.5f, 0.6f}, {0.02f, 0, 0}, 30), 200);
}

// Within the inner cone nothing falls off, however narrow and hard the cone is.
TEST_F(RendererLight, HardAndNarrowSpots) {
    for (const auto& [inner, outer] :
         std::vector<std::pair<float, float>>{{20, 20}, {5, 5}, {1.5f, 1.5f}, {0.5f, 0.5f}, {3, 3.5f}}) {
        Scene scene;
        addFloor(scene, lambert(1), 4);
        scene.lights.push_back(spotLight(glm::vec3(8), {0, 2, 0}, {0, -1, 0}, inner, outer));
        const RendererWorld world = worldOfQuads(scene, 2);
        Renderer renderer(world.input(), kShaderFolder);
        const float radius = 2 * std::tan(glm::radians(outer));
        const Camera camera = lookAtCamera({0, 1, 0}, {0, 0, 0}, 2 * glm::degrees(std::atan(1.5f * radius)));
        const Image image = renderer.render(frame(camera));
        int lit = 0, dark = 0;
        for (int y = 0; y < image.height; ++y)
            for (int x = 0; x < image.width; ++x) {
                const glm::vec3 ray = pixelDirection(camera, x, y, image.width, image.height);
                const double across = double(glm::length(glm::vec2(ray.x, ray.z)) / -ray.y);
                const double angle = glm::degrees(std::atan(across / 2)), distance2 = 4 + across * across;
                const double value = double(image.at(x, y).x);
                if (angle < 0.98 * double(inner)) {
                    const double expected = 8 / distance2 * 2 / std::sqrt(distance2) / double(kPi);
                    ASSERT_NEAR(value, expected, 2e-3 * expected) << inner << " at " << angle;
                    ++lit;
                }
                if (angle > 1.02 * double(outer)) {
                    ASSERT_EQ(value, 0) << outer << " at " << angle;
                    ++dark;
                }
            }
        EXPECT_GT(lit, 500);
        EXPECT_GT(dark, 500);
    }
}

// The window sets lights and materials after every edit, whatever it was of.
TEST_F(RendererLight, ShadowMapsAreDrawnAgainWhenTheyChangeAndOnlyThen) {
    Scene scene = floorAndShelf(0.4f);
    scene.lights.push_back(pointLight({3, 4, 5}, {0.3f, 1.5f, 0.2f}));
    RendererWorld world = worldOfQuads(scene, 2);
    Renderer renderer(world.input(), kShaderFolder);
    const FrameSettings settings = frame(lookAtCamera({1.5f, 2, 2.5f}, {0, 0, 0}, 50));
    const auto drawsShadows = [&] {
        renderer.render(settings);
        return renderer.lastFrameTimes().shadows > 0;
    };
    EXPECT_TRUE(drawsShadows());
    EXPECT_FALSE(drawsShadows());
    renderer.setLights(world.scene.lights);
    EXPECT_FALSE(drawsShadows()) << "the same lights";
    world.scene.materials[1].roughness = 0.9f;
    world.scene.materials[1].baseColor.r = 0.1f;
    renderer.setMaterials(world.scene.materials);
    EXPECT_FALSE(drawsShadows()) << "a material that is as opaque as before";
    world.scene.materials[1].baseColor.a = 0.2f;
    world.scene.materials[1].alphaMode = AlphaMode::mask;
    renderer.setMaterials(world.scene.materials);
    EXPECT_TRUE(drawsShadows()) << "the shelf is gone";
    world.scene.lights[0].position.x += 0.1f;
    renderer.setLights(world.scene.lights);
    EXPECT_TRUE(drawsShadows()) << "another light";
    renderer.moveScene(world.scene, world.atlas, world.points, {});
    EXPECT_TRUE(drawsShadows()) << "geometry has moved";
    EXPECT_EQ(renderer.render(settings).pixels,
              Renderer(world.input(), kShaderFolder).render(settings).pixels);
}

// A lamp almost in the plane of the floor: neither acne nor a gap.
TEST_F(RendererLight, GrazingLightHasNoAcne) {
    Scene scene;
    addFloor(scene, lambert(0.8f), 4);
    scene.lights.push_back(pointLight(glm::vec3(10), {-1.9f, 0.15f, 0.1f}));
    comparePictures(worldOfQuads(scene, 2), lookAtCamera({1.5f, 2, 2.5f}, {0, 0, 0}, 50), 0);
}

// A wall that stands on the floor: its shadow begins at its foot.
TEST_F(RendererLight, ShadowTouchesItsCaster) {
    Scene scene;
    addFloor(scene, lambert(0.8f), 4);
    addQuad(scene, lambert(0.5f), {0, 0, -1}, {0, 1, 0}, {0, 0, 2});
    scene.materials.back().doubleSided = true;
    scene.lights.push_back(pointLight(glm::vec3(10), {-1.5f, 1.2f, 0}));
    comparePictures(worldOfQuads(scene, 2), lookAtCamera({0.5f, 0.5f, 0.6f}, {0.02f, 0, 0}, 30), 200);
}

}  // namespace
}  // namespace phat::test
