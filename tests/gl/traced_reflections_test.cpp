// Rays instead of the lookup: closed forms on quads whose irradiance is known.

#include "core/render/traced_reflections.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <optional>

#include "core/scene/camera_ray.h"
#include "gl/traced_frame.h"
#include "gl/traced_world.h"

namespace phat::test {
namespace {

/// Traces from the floor's middle, seen from an eye that looks down at 45 degrees.
struct FloorProbe : WorldOfRays {
    using WorldOfRays::WorldOfRays;

    std::vector<SurfaceIncident> trace(float roughness, uint32_t count, float weight = 1) const {
        ReflectionView view;
        view.camera = lookAtCamera({0, 1, 1}, {0.1f, 0, 0}, 1);
        view.width = int(count);
        view.height = 1;
        TracedSurface surface;
        surface.position = {0.5f * float(count), 0.5f};
        surface.triangle = rays.closestHit({0, 1, 1}, glm::normalize(glm::vec3(0.1f, -1, -1))).triangle;
        surface.base = {{0, 1, 0}, std::max(square(roughness), kMinAlpha), 1, 1, weight, 2};
        std::vector<TracedSurface> surfaces(count, surface);
        for (uint32_t i = 0; i < count; ++i) surfaces[i].pixel = i;
        SilentProgress silent;
        uint64_t rayCount = 0;
        auto incident = traceReflections(scene, view, surfaces, silent, rayCount);
        EXPECT_GE(rayCount, count);
        return incident;
    }
    LobeIncident mean(float roughness, uint32_t count) const {
        LobeIncident sum;
        for (const SurfaceIncident& incident : trace(roughness, count)) {
            sum.indirect += incident.base.indirect / float(count);
            sum.area += incident.base.area / float(count);
        }
        return sum;
    }
};

TEST(TracedReflections, MirrorShowsAlbedoTimesIrradiance) {
    RendererWorld world = worldOfQuads(floorAndCeiling(whiteMetal(0), lambert(0.5f)), 4);
    setIrradiance(world, 1, 3);
    const LobeIncident incident = FloorProbe(world).mean(0, 4);
    EXPECT_NEAR(incident.indirect.x, 0.5f * 3 / kPi, 2e-3f);  // RGB9E5 rounds by up to 2^-9
    EXPECT_EQ(incident.area, glm::vec3(0));
}

// A ray far from the peak of a mirror's lobe would be all that its pixel shows.
TEST(TracedReflections, MirrorsOfASkyHaveNoSpecks) {
    for (const bool bright : {true, false}) {
        Scene scene;
        addFloor(scene, whiteMetal(0), 8);
        const float ahead = bright ? 10.0f : 0.1f;
        scene.environment = skyOfHalves(ahead, bright ? 0.1f : 10.0f);
        const RendererWorld world = worldOfQuads(std::move(scene), 4);
        for (const SurfaceIncident& incident : FloorProbe(world).trace(0.05f, 16384))
            ASSERT_NEAR(incident.base.area.x, ahead, 0.01f * ahead);
    }
}

TEST(TracedReflections, EmissionCountsOnceAndAsAreaLight) {
    const RendererWorld world = worldOfQuads(floorAndCeiling(whiteMetal(0), emitter(glm::vec3(7)), 400), 4);
    const FloorProbe probe(world);
    for (float roughness : {0.0f, 0.1f, 0.18f}) {
        const LobeIncident incident = probe.mean(roughness, 4096);
        EXPECT_NEAR(incident.area.x, 7, 0.03f) << roughness;
        EXPECT_EQ(incident.indirect, glm::vec3(0)) << roughness;
    }
}

// A lamp far smaller than the lobe: light samples and the lobe's own rays find it without loss. The exact
// value is the integral of the lobe over the lamp, over the lobe's albedo.
TEST(TracedReflections, SmallLampBringsItsShareOfTheLobe) {
    constexpr float kSide = 0.04f, kRoughness = 0.18f;
    Scene scene;
    addFloor(scene, whiteMetal(0), 8);
    addCeiling(scene, emitter(glm::vec3(1000)), kSide, 2);
    const glm::vec3 shift(0.2f, 0, -2);  // where the mirror image lies
    for (uint32_t i = scene.surfaces[1].firstVertex; i < scene.positions.size(); ++i)
        scene.positions[i] += shift;
    const RendererWorld world = worldOfQuads(std::move(scene), 4);

    const glm::vec3 floorPoint(0.1f, 0, 0), lamp = glm::vec3(0, 2, 0) + shift;
    const glm::vec3 towardEye = glm::normalize(glm::vec3(0, 1, 1) - floorPoint);
    const Frame frame = frameFromNormal({0, 1, 0});
    Brdf brdf;
    brdf.f0 = glm::vec3(1);
    brdf.alpha = square(kRoughness);
    double expected = 0;
    constexpr int kSteps = 16;
    for (int i = 0; i < kSteps * kSteps; ++i) {
        const glm::vec2 at = (glm::vec2(i % kSteps, i / kSteps) + 0.5f) / float(kSteps) - 0.5f;
        const glm::vec3 way = lamp + kSide * glm::vec3(at.x, 0, at.y) - floorPoint;
        const glm::vec3 toward = glm::normalize(way);
        const float solidAngle = square(kSide / kSteps) * toward.y / glm::dot(way, way);
        expected +=
            1000.0 * solidAngle * evaluateBrdf(brdf, frame.toLocal(towardEye), frame.toLocal(toward)).x;
    }
    expected /= specularAlbedo(brdf.f0, 1, brdf.alpha, towardEye.y).x;
    EXPECT_NEAR(FloorProbe(world).mean(kRoughness, 16384).area.x, expected, 0.02 * expected);
}

TEST(TracedReflections, MirrorInAMirrorIsNotBlack) {
    Scene scene = floorAndCeiling(whiteMetal(0), whiteMetal(0));
    addQuad(scene, lambert(0.5f), {-4, 0, -4}, {8, 0, 0}, {0, 8, 0});  // behind, up beside both
    RendererWorld world = worldOfQuads(std::move(scene), 4);
    setIrradiance(world, 2, 3);
    // 45 degrees: up at z = -2 to the ceiling, down at z = -4 to the wall.
    const LobeIncident incident = FloorProbe(world).mean(0, 256);
    EXPECT_NEAR(incident.indirect.x, 0.5f * 3 / kPi, 0.02f);
}

/// A picture of the floor, all of whose pixels are traced; by the pixel.
std::vector<SurfaceIncident> traceFloor(const WorldOfRays& world, float roughness, const Camera& camera,
                                        int side, uint32_t frame = 0) {
    ReflectionView view;
    view.camera = camera;
    view.width = view.height = side;
    view.frame = frame;
    std::vector<TracedSurface> surfaces;
    for (int i = 0; i < side * side; ++i) {
        TracedSurface s;
        s.pixel = uint32_t(i);
        s.position = glm::vec2(i % side, i / side) + 0.5f;
        const Ray eye = cameraRay(camera, side, side, s.position);
        s.triangle = world.rays.closestHit(eye.origin, eye.direction).triangle;
        s.base = {{0, 1, 0}, std::max(square(roughness), kMinAlpha), 1, 1, 1, 2};
        surfaces.push_back(s);
    }
    SilentProgress silent;
    uint64_t rayCount = 0;
    return traceReflections(world.scene, view, surfaces, silent, rayCount);
}

// A line in eight is dark, and a pixel shows some three of them in the mirror: one ray has their mean.
TEST(TracedReflections, MirroredTexturesAreFiltered) {
    Material lined = emitter(glm::vec3(1));
    lined.emissionTexture.image = 0;
    Scene scene = floorAndCeiling(whiteMetal(0), lined);
    TextureImage image;
    image.width = image.height = 2048;
    for (int i = 0; i < 2048 * 2048; ++i)
        image.texels.push_back(glm::u8vec4(glm::u8vec3(i % 8 ? 255 : 0), 255));
    scene.images.push_back(image);
    const RendererWorld world = worldOfQuads(std::move(scene), 4);
    const auto seen = traceFloor(WorldOfRays(world), 0, lookAtCamera({0, 1, 1}, {0.1f, 0, 0}, 20), 16);
    int far = 0;  // a ray in the lobe's tail
    for (const SurfaceIncident& s : seen) far += std::abs(s.base.area.x - 7 / 8.0f) > 0.02f;
    EXPECT_LE(far, 2);
}

// Pixels of a mirror that see a rough metal share the walks from there: their noise against that of a pixel
// alone.
TEST(TracedReflections, MirrorsShareWhatTheyHit) {
    Scene scene = floorAndCeiling(whiteMetal(0), whiteMetal(0.6f));
    addQuad(scene, emitter(glm::vec3(100)), {0.5f, 1, -2.5f}, {0, 0, 0.1f}, {0.1f, 0, 0});
    const RendererWorld world = worldOfQuads(std::move(scene), 4);
    const WorldOfRays rays(world);
    constexpr int kSide = 9, kFrames = 48;
    const Camera many = lookAtCamera({0, 1, 1}, {0, 0, 0}, 2),
                 one = lookAtCamera({0, 1, 1}, {0, 0, 0}, 2.0f / kSide);
    double sums[2] = {}, squares[2] = {};
    for (uint32_t frame = 0; frame < kFrames; ++frame) {
        const double seen[2] = {
            double(traceFloor(rays, 0, many, kSide, frame)[kSide * kSide / 2].base.indirect.x),
            double(traceFloor(rays, 0, one, 1, frame)[0].base.indirect.x)};
        for (int i = 0; i < 2; ++i) {
            sums[i] += seen[i] / kFrames;
            squares[i] += seen[i] * seen[i] / kFrames;
        }
    }
    const auto deviation = [&](int i) { return std::sqrt(squares[i] - sums[i] * sums[i]); };
    EXPECT_GT(sums[1], 0.01);
    EXPECT_NEAR(sums[0], sums[1], 4 * deviation(1) / std::sqrt(double(kFrames)));
    EXPECT_LT(deviation(0), 0.5 * deviation(1));  // a quarter, where 16 count for one
}

TEST(TracedReflections, ThreadsDoNotChangeThem) {
    RendererWorld world = worldOfQuads(floorAndCeiling(whiteMetal(0), whiteMetal(0.3f)), 4);
    setIrradiance(world, 0, 1);
    const FloorProbe probe(world);
    const auto with = [&](size_t threads) {
        const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
        return probe.trace(0.15f, 1000);
    };
    const auto one = with(1), four = with(4);
    for (size_t i = 0; i < one.size(); ++i) {
        EXPECT_EQ(one[i].base.indirect, four[i].base.indirect);
        EXPECT_EQ(one[i].base.area, four[i].base.area);
    }
}

// The picture of a ceiling on a floor with so many texels a metre.
uint64_t raysFor(float roughness, float height, float texelsPerMeter) {
    Scene scene;
    addFloor(scene, whiteMetal(roughness), 4);
    addCeiling(scene, lambert(0.5f), 4, height);
    RendererWorld world = worldOfQuads(std::move(scene), texelsPerMeter);
    fillWithLookups(world, 2, 0);
    const WorldOfRays traceable(world);
    SilentProgress silent;
    const TracedReflections traced{traceable.scene, Reflections::automatic, silent};
    Renderer renderer(world.input(), kShaderFolder);
    FrameSettings settings;
    settings.width = 16;
    settings.height = 12;
    settings.camera = lookAtCamera({0, 0.5f * height, 0.5f * height}, {0.1f, 0, 0}, 20);
    settings.samplesPerPixel = 1;
    PictureSum sum;
    return drawFrame(renderer, settings, &traced, sum).rays;
}

TEST(TracedReflections, LobesSharperThanThePhatexelsAroundAreTraced) {
    const HeadlessContext context;
    EXPECT_GT(raysFor(0.05f, 2, 48), 0u);
    EXPECT_EQ(raysFor(0.5f, 2, 48), 0u);
    EXPECT_GT(raysFor(0.5f, 2, 8), 0u);       // texels too far apart
    EXPECT_GT(raysFor(0.5f, 0.05f, 48), 0u);  // or what is reflected is too close
    EXPECT_EQ(raysFor(1, 2, 48), 0u);
}

/// A floor whose lookup says 2, under a panel of radiance 5, and a frame that shows its middle.
struct MirrorUnderPanel {
    MirrorUnderPanel() {
        fillWithLookups(world, 2, 0);
        settings.width = 32;
        settings.height = 24;
        settings.camera = lookAtCamera({0, 1, 1}, {0.1f, 0, 0}, 30);
        settings.samplesPerPixel = 2;
        traceable.emplace(world);
    }
    TracedReflections traced(Reflections reflections) { return {traceable->scene, reflections, silent}; }

    RendererWorld world = worldOfQuads(floorAndCeiling(whiteMetal(0.05f), emitter(glm::vec3(5))), 4);
    FrameSettings settings;
    std::optional<WorldOfRays> traceable;
    SilentProgress silent;
};

// In the picture: what the lookup would say is replaced, not added to.
TEST(TracedReflections, ReplaceTheLookup) {
    const HeadlessContext context;
    MirrorUnderPanel mirror;
    Renderer renderer(mirror.world.input(), kShaderFolder);
    FrameSettings& settings = mirror.settings;
    uint64_t rays = 0;
    const auto middle = [&](const TracedReflections* traced, Component component) {
        settings.component = component;
        PictureSum sum;
        rays = drawFrame(renderer, settings, traced, sum).rays;
        return readMean(sum).at(16, 12).x;
    };
    EXPECT_NEAR(middle(nullptr, Component::glossyIndirect), 2, 0.02f);
    EXPECT_NEAR(middle(nullptr, Component::direct), 0, 1e-4f);
    const TracedReflections traced = mirror.traced(Reflections::automatic);
    EXPECT_NEAR(middle(&traced, Component::all), 5, 0.02f);
    EXPECT_NEAR(middle(&traced, Component::direct), 5, 0.02f);
    EXPECT_NEAR(middle(&traced, Component::glossyIndirect), 0, 1e-4f);
    EXPECT_GT(rays, 0u);
    const TracedReflections none = mirror.traced(Reflections::lookup);
    EXPECT_NEAR(middle(&none, Component::all), 2, 0.02f);
    EXPECT_EQ(rays, 0u);
}

// A sample that is given up, for its rays take too long, leaves the sum as it was and the next one right.
TEST(TracedReflections, AnUnfinishedSampleLeavesNothing) {
    const HeadlessContext context;
    MirrorUnderPanel mirror;
    Renderer renderer(mirror.world.input(), kShaderFolder);
    FrameSettings& settings = mirror.settings;
    settings.samplesPerDraw = 1;
    const TracedReflections traced = mirror.traced(Reflections::automatic);
    PictureSum whole, interrupted;
    for (int i = 0; i < 2; ++i) drawFrame(renderer, settings, &traced, whole);
    drawFrame(renderer, settings, &traced, interrupted);
    const PendingSample sample = renderer.beginSample(settings, Reflections::automatic, interrupted);
    EXPECT_GT(sample.surfaces.size(), 0u);
    EXPECT_EQ(interrupted.samples, 1);
    drawFrame(renderer, settings, &traced, interrupted);
    EXPECT_EQ(interrupted.samples, 2);
    EXPECT_EQ(readMean(interrupted).pixels, readMean(whole).pixels);
}

// Every pixel's ray starts where the rasteriser drew it: the floor mirrors a ceiling whose left half is
// brighter, and the border lies where geometry says, to the pixel.
TEST(TracedReflections, AgreeWithTheRasterisersGeometry) {
    const HeadlessContext context;
    Scene scene = mirrorUnderTwoPanels();
    RendererWorld world = worldOfQuads(std::move(scene), 4);
    fillWithLookups(world, 3, 2);
    const WorldOfRays traceable(world);
    SilentProgress silent;
    const TracedReflections traced{traceable.scene, Reflections::rays, silent};
    Renderer renderer(world.input(), kShaderFolder);
    FrameSettings settings;
    settings.width = 64;
    settings.height = 48;
    settings.camera = lookAtCamera({0.3f, 1, 1}, {-0.2f, 0, 0}, 40);
    settings.samplesPerPixel = 1;
    PictureSum sum;
    drawFrame(renderer, settings, &traced, sum);
    expectMirroredBorder(readMean(sum), settings.camera);
}

}  // namespace
}  // namespace phat::test
