// Rays that the GPU traces: closed forms on quads whose irradiance is known, and what follows from edits,
// moves and frames before.

#include <gtest/gtest.h>

#include <glm/gtc/matrix_transform.hpp>

#include "core/scene/brdf.h"
#include "gl/traced_world.h"

namespace phat::test {
namespace {

TEST(GpuRays, MirrorShowsAlbedoTimesIrradiance) {
    GpuWorld gpu(floorAndCeiling(whiteMetal(0), lambert(0.5f)));
    setIrradiance(gpu.world, 1, 3);
    Renderer renderer(gpu.input(), kShaderFolder);
    EXPECT_NEAR(gpu.middle(renderer, Component::glossyIndirect), 0.5f * 3 / kPi, 3e-3f);
    EXPECT_NEAR(gpu.middle(renderer, Component::direct), 0, 1e-4f);
    gpu.frame.tracedByGpu = Reflections::lookup;
    EXPECT_NEAR(gpu.middle(renderer, Component::glossyIndirect), 2, 0.02f);
}

TEST(GpuRays, MirrorShowsTheTexelThatItHits) {
    GpuWorld gpu(floorAndCeiling(whiteMetal(0), lambert(0.5f)));
    const Atlas& atlas = gpu.world.atlas;
    // A ramp, but for the other charts.
    for (uint32_t y = 0; y < atlas.sizeTexels.y; ++y)
        for (uint32_t x = 0; x < atlas.sizeTexels.x; ++x) {
            const size_t texel = size_t(y) * atlas.sizeTexels.x + x;
            const glm::vec3 position = gpu.world.points.position[texel];
            const bool ceiling = atlas.chartAt({x, y}) == 1;
            gpu.world.phatexture.indirectIrradiance[texel] =
                packRgb9e5(glm::vec3(ceiling ? 4 + 0.5f * position.x + 0.25f * position.z : 0));
        }
    Renderer renderer(gpu.input(), kShaderFolder);
    for (const glm::vec2 at : {glm::vec2(0.1f, 0), glm::vec2(-0.6f, 0.3f)}) {
        gpu.frame.camera = lookAtCamera({0, 1, 1}, {at.x, 0, at.y}, 1);
        // Down by one metre, up by two.
        const glm::vec2 seen = at + 2.0f * (at - glm::vec2(0, 1));
        const float irradiance = 4 + 0.5f * seen.x + 0.25f * seen.y;
        EXPECT_NEAR(gpu.middle(renderer, Component::glossyIndirect), 0.5f / kPi * irradiance, 0.01f);
    }
}

// The lobe's rays and the light samples share the panel's light, whatever the lobe's width.
TEST(GpuRays, EmissionCountsOnceAndAsAreaLight) {
    for (float roughness : {0.0f, 0.1f, 0.3f, 0.6f}) {
        Scene scene = floorAndCeiling(whiteMetal(roughness), emitter(glm::vec3(7)), 400);
        // Seen by nobody: with it no clamp to the brightest light hides what is too bright.
        addQuad(scene, emitter(glm::vec3(1000)), {0, 5, 0}, {0, 0, 0.1f}, {0.1f, 0, 0});
        GpuWorld gpu(std::move(scene));
        gpu.frame.samplesPerPixel = 64;
        Renderer renderer(gpu.input(), kShaderFolder);
        const float albedo = specularAlbedo(glm::vec3(1), 1, std::max(square(roughness), kMinAlpha), 0.7f).x;
        EXPECT_NEAR(gpu.middle(renderer, Component::direct), 7 * albedo, 0.03f * 7) << roughness;
        EXPECT_NEAR(gpu.middle(renderer, Component::glossyIndirect), 0, 1e-3f) << roughness;
    }
}

/// A parallelogram of one radiance.
struct Panel {
    glm::vec3 corner, u, v;
    float radiance;
};

// What the lobe of a white metal floor at `at` reflects of a panel, by integration over it.
double reflectedOf(const Panel& panel, glm::vec3 at, glm::vec3 eye, float roughness) {
    const Frame frame = frameFromNormal({0, 1, 0});
    const glm::vec3 towardEye = frame.toLocal(glm::normalize(eye - at));
    const glm::vec3 normal = glm::cross(panel.u, panel.v);  // its length is the area
    Brdf brdf;
    brdf.f0 = glm::vec3(1);
    brdf.alpha = square(roughness);
    constexpr int kSteps = 128;
    double sum = 0;
    for (int i = 0; i < kSteps * kSteps; ++i) {
        const glm::vec2 square = (glm::vec2(i % kSteps, i / kSteps) + 0.5f) / float(kSteps);
        const glm::vec3 way = panel.corner + square.x * panel.u + square.y * panel.v - at;
        const float distance = glm::length(way);
        const glm::vec3 toward = way / distance;
        if (toward.y <= 0) continue;
        const float solidAngle = std::abs(glm::dot(normal, toward)) / (kSteps * kSteps * distance * distance);
        sum += double(panel.radiance * solidAngle) *
               double(evaluateBrdf(brdf, towardEye, frame.toLocal(toward)).x);
    }
    return sum;
}

// A lamp far smaller than the lobe, and panels that light samples and the lobe's rays find alike.
TEST(GpuRays, LampsBringTheirShareOfTheLobe) {
    struct Case {
        float side, radiance, roughness;
    };
    for (const Case& c : {Case{0.04f, 1000, 0.3f}, Case{1, 5, 0.5f}, Case{3, 5, 0.7f}}) {
        Scene scene;
        addFloor(scene, whiteMetal(c.roughness), 8);
        addCeiling(scene, emitter(glm::vec3(c.radiance)), c.side, 2);
        const glm::vec3 shift(0.2f, 0, -2);  // where the mirror image lies
        for (uint32_t i = scene.surfaces[1].firstVertex; i < scene.positions.size(); ++i)
            scene.positions[i] += shift;
        // Seen by nobody: with it no clamp to the brightest light hides what is too bright.
        addQuad(scene, emitter(glm::vec3(1e4f)), {0, 5, 0}, {0, 0, 0.01f}, {0.01f, 0, 0});
        GpuWorld gpu(std::move(scene));
        gpu.frame.camera = lookAtCamera({0, 1, 1}, {0.1f, 0, 0}, 0.2f);
        gpu.frame.samplesPerPixel = 256;
        Renderer renderer(gpu.input(), kShaderFolder);
        const glm::vec3 corner = glm::vec3(-c.side / 2, 2, -c.side / 2) + shift;
        const Panel panel{corner, {c.side, 0, 0}, {0, 0, c.side}, c.radiance};
        const double expected = reflectedOf(panel, {0.1f, 0, 0}, {0, 1, 1}, c.roughness);
        EXPECT_NEAR(gpu.middle(renderer, Component::direct), expected, 0.03 * expected) << c.side;
    }
}

// At a grazing angle a lobe is narrow from side to side: neighbours whose lobes point elsewhere must not blur
// a border that runs away from the eye.
TEST(GpuRays, GrazingLobesKeepTheBordersThatTheyShow) {
    constexpr float kRoughness = 0.3f, kFar = 2;
    Scene scene;
    addFloor(scene, whiteMetal(kRoughness), 8);
    const auto addWall = [&](float left) {
        addQuad(scene, lambert(0.5f), {left, 0, -kFar}, {4, 0, 0}, {0, 4, 0});
    };
    addWall(-4);  // surface 1, dark
    addWall(0);
    GpuWorld gpu(std::move(scene));
    setIrradiance(gpu.world, 2, 2 * kPi);  // radiance 1
    const glm::vec3 eye(0, 0.35f, 1.5f);
    gpu.frame.camera = lookAtCamera(eye, {0, 0, 0}, 11);
    gpu.frame.component = Component::glossyIndirect;
    gpu.frame.samplesPerPixel = 64;
    gpu.frame.filter = PixelFilter::center;
    Renderer renderer(gpu.input(), kShaderFolder);
    const Image image = renderer.render(gpu.frame);

    const int y = image.height / 2;
    double error = 0, mean = 0;
    for (int x = 0; x < image.width; ++x) {
        const glm::vec3 d = pixelDirection(gpu.frame.camera, x, y, image.width, image.height);
        const glm::vec3 floor = eye - eye.y / d.y * d;
        const Panel right{{0, 0, -kFar}, {4, 0, 0}, {0, 4, 0}, 1};
        const double expected = reflectedOf(right, floor, eye, kRoughness);
        error += std::abs(double(image.at(x, y).x) - expected);
        mean += expected;
    }
    EXPECT_LT(error, 0.045 * mean);
}

// What a hit reflects sharply is the PHATexels' there: the paper's structure at the second bounce.
TEST(GpuRays, MirrorInAMirrorShowsItsPhatexels) {
    GpuWorld gpu(floorAndCeiling(whiteMetal(0), whiteMetal(0)));
    setIrradiance(gpu.world, 1, 2 * kPi);
    Renderer renderer(gpu.input(), kShaderFolder);
    EXPECT_NEAR(gpu.middle(renderer, Component::glossyIndirect), 2, 0.05f);
}

TEST(GpuRays, PunctualLightOnWhatIsMirrored) {
    Scene scene = floorAndCeiling(whiteMetal(0), lambert(0.5f));
    PunctualLight lamp;
    lamp.position = {0.3f, 1, -2};  // a metre under what is mirrored
    lamp.intensity = glm::vec3(4);
    scene.lights.push_back(lamp);
    GpuWorld lit(scene);
    Renderer renderer(lit.input(), kShaderFolder);
    EXPECT_NEAR(lit.middle(renderer, Component::glossyIndirect), 0.5f / kPi * 4, 0.01f);

    addQuad(scene, lambert(0), {0.2f, 1.5f, -2.1f}, {0.2f, 0, 0}, {0, 0, 0.2f});  // between the two, small
    GpuWorld shadowed(scene);
    Renderer another(shadowed.input(), kShaderFolder);
    shadowed.frame.camera = lookAtCamera({0, 1, 1}, {0.1f, 0, 0}, 1);
    EXPECT_NEAR(shadowed.middle(another, Component::glossyIndirect), 0, 1e-3f);
}

// Every pixel's ray starts where the rasteriser drew it: the border between two panels lies where geometry
// says.
TEST(GpuRays, AgreeWithTheRasterisersGeometry) {
    Scene scene = mirrorUnderTwoPanels();
    GpuWorld gpu(std::move(scene));
    gpu.frame.width = 64;
    gpu.frame.height = 48;
    gpu.frame.samplesPerPixel = 1;
    gpu.frame.camera = lookAtCamera({0.3f, 1, 1}, {-0.2f, 0, 0}, 40);
    Renderer renderer(gpu.input(), kShaderFolder);
    expectMirroredBorder(renderer.render(gpu.frame), gpu.frame.camera);
}

TEST(GpuRays, FollowEditsAndMoves) {
    Scene scene = floorAndCeiling(whiteMetal(0), emitter(glm::vec3(5)));
    scene.surfaces[1].node = 1;
    GpuWorld gpu(std::move(scene));
    gpu.frame.samplesPerPixel = 1;
    gpu.frame.followsLast = true;
    Renderer renderer(gpu.input(), kShaderFolder);
    EXPECT_NEAR(gpu.middle(renderer, Component::direct), 5, 0.05f);
    std::vector<Material> materials = gpu.world.scene.materials;
    materials[1].emission = glm::vec3(3);
    renderer.setMaterials(materials);
    EXPECT_NEAR(gpu.middle(renderer, Component::direct), 3, 0.05f)
        << "at once, although frames follow one another";

    // The ceiling goes far away to the side.
    const glm::mat4 away = glm::translate(glm::mat4(1), glm::vec3(100, 0, 0));
    const Surface& ceiling = gpu.world.scene.surfaces[1];
    for (uint32_t v = 0; v < ceiling.vertexCount; ++v)
        gpu.world.scene.positions[ceiling.firstVertex + v].x += 100;
    std::vector<glm::mat4> worldFromRest(ceiling.node + 1, glm::mat4(1));
    worldFromRest[ceiling.node] = away;
    renderer.moveScene(gpu.world.scene, gpu.world.atlas, gpu.world.points, worldFromRest);
    EXPECT_NEAR(gpu.middle(renderer, Component::direct), 0, 1e-3f);
}

// Nothing of the rays is on the GPU before the first frame that traces some.
TEST(GpuRays, KnowEditsFromBeforeTheirFirstFrame) {
    GpuWorld gpu(floorAndCeiling(whiteMetal(0), emitter(glm::vec3(5))));
    Renderer renderer(gpu.input(), kShaderFolder);
    std::vector<Material> materials = gpu.world.scene.materials;
    materials[1].emission = glm::vec3(3);
    renderer.setMaterials(materials);
    EXPECT_NEAR(gpu.middle(renderer, Component::direct), 3, 0.05f);
}

// A view that moves: with the frames before, the noise of a rough floor is a fraction of one frame's.
TEST(GpuRays, FramesBeforeTakeNoiseAway) {
    Scene scene;
    addFloor(scene, whiteMetal(0.4f), 8);
    for (int stripe = 0; stripe < 8; ++stripe)
        addQuad(scene, emitter(glm::vec3(stripe % 2 ? 9 : 1)), {-4.0f + float(stripe), 2, -4}, {1, 0, 0},
                {0, 0, 8});
    GpuWorld gpu(std::move(scene));
    gpu.frame.width = 96;
    gpu.frame.height = 64;
    gpu.frame.component = Component::direct;
    gpu.frame.rays.lightSamples = 1;
    Renderer renderer(gpu.input(), kShaderFolder);
    const auto cameraAt = [](int frame) {
        return lookAtCamera({0.02f * float(frame), 1, 1}, {0.1f + 0.02f * float(frame), 0, 0}, 30);
    };
    constexpr int kFrames = 12;
    FrameSettings exact = gpu.frame;
    exact.camera = cameraAt(kFrames - 1);
    exact.samplesPerPixel = 256;
    exact.filter = PixelFilter::center;
    const Image reference = renderer.render(exact);
    const auto errorOf = [&](bool follows) {
        FrameSettings moving = gpu.frame;
        moving.samplesPerPixel = 1;
        moving.followsLast = follows;
        Image image;
        for (int i = 0; i < kFrames; ++i) {
            moving.camera = cameraAt(i);
            moving.seed = uint32_t(i);
            image = renderer.render(moving);
        }
        double sum = 0;
        for (size_t i = 0; i < image.pixels.size(); ++i)
            sum += std::abs(double(image.pixels[i].x - reference.pixels[i].x));
        return sum / double(image.pixels.size());
    };
    const double alone = errorOf(false), together = errorOf(true);
    EXPECT_GT(alone, 0.01);
    EXPECT_LT(together, 0.6 * alone);
}

// Mirrors trace one ray a pixel, and pixels that show no lobe none.
TEST(GpuRays, AreCounted) {
    GpuWorld gpu(floorAndCeiling(whiteMetal(0), lambert(0.5f)));
    gpu.frame.samplesPerPixel = 3;
    Renderer renderer(gpu.input(), kShaderFolder);
    renderer.render(gpu.frame);
    EXPECT_EQ(renderer.lastFrameRays(), 3u * 32 * 24);
    gpu.frame.tracedByGpu = Reflections::lookup;
    renderer.render(gpu.frame);
    EXPECT_EQ(renderer.lastFrameRays(), 0u);
}

// Every program counts what it reads: with a lamp above, light samples read more; no lookup does.
TEST(GpuRays, FetchesAreCounted) {
    GpuWorld gpu(floorAndCeiling(whiteMetal(0.3f), emitter(glm::vec3(5))));
    Renderer renderer(gpu.input(), kShaderFolder);
    const uint64_t one = renderer.countRayFetches(gpu.frame);
    EXPECT_EQ(renderer.countRayFetches(gpu.frame), one);
    gpu.frame.samplesPerPixel = 1;
    renderer.render(gpu.frame);
    EXPECT_GT(one, 20 * renderer.lastFrameRays()) << "two triangles, their surface, and what is pooled";
    gpu.frame.rays.lightSamples = 2;
    EXPECT_GT(renderer.countRayFetches(gpu.frame), one + 5u * 32 * 24);
    gpu.frame.tracedByGpu = Reflections::lookup;
    EXPECT_EQ(renderer.countRayFetches(gpu.frame), 0u);
}

// Many rays a pixel are traced pass after pass, each over the pixels that trace so many.
TEST(GpuRays, BudgetsLimitThem) {
    Scene scene;
    addFloor(scene, whiteMetal(0.3f), 8);
    addCeiling(scene, emitter(glm::vec3(5)), 8, 0.05f);  // so near that pixels share nothing
    GpuWorld gpu(std::move(scene));
    gpu.frame.camera = lookAtCamera({0, 0.04f, 0.04f}, {0.004f, 0, 0}, 40);
    gpu.frame.samplesPerPixel = 1;
    Renderer renderer(gpu.input(), kShaderFolder);
    uint64_t last = 0;
    for (int most : {1, 2, 4, 8}) {
        gpu.frame.rays = {64, most, 1};
        renderer.render(gpu.frame);
        EXPECT_GT(renderer.lastFrameRays(), last) << most;
        EXPECT_LE(renderer.lastFrameRays(), uint64_t(most) * 32 * 24) << most;
        last = renderer.lastFrameRays();
    }
}

// Files of programs that knew no trees, and scenes too large for them.
TEST(GpuRays, WithoutTreesReflectionsAreLookedUp) {
    GpuWorld gpu(floorAndCeiling(whiteMetal(0), emitter(glm::vec3(5))));
    Renderer renderer(gpu.world.input(), kShaderFolder);
    EXPECT_NEAR(gpu.middle(renderer, Component::glossyIndirect), 2, 0.02f);
    EXPECT_EQ(renderer.residentBytes().rays, 0u);
}

}  // namespace
}  // namespace phat::test
