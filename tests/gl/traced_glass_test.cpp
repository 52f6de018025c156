// Rays that bring a pane what it mirrors.

#include <gtest/gtest.h>

#include "core/scene/brdf.h"
#include "gl/traced_frame.h"
#include "gl/traced_world.h"
#include "support/glass_scenes.h"

namespace phat::test {
namespace {

// Glass that reflects more than two thirds.
constexpr float kIor = 11, kF0 = 100.0f / 144.0f;
constexpr float kBelow = 0.5f;  // radiance

// A pane under a ceiling whose right half is brighter, above an emitter.
struct PaneUnderCeiling {
    explicit PaneUnderCeiling(int panes) {
        Scene scene;
        addFloor(scene, glass(kIor), 8);
        addQuad(scene, emitter(glm::vec3(1)), {-4, 2, -4}, {4, 0, 0}, {0, 0, 8});
        addQuad(scene, emitter(glm::vec3(9)), {0, 2, -4}, {4, 0, 0}, {0, 0, 8});
        addFloor(scene, emitter(glm::vec3(kBelow)), 20, -1);
        if (panes == 2) addFloor(scene, glass(kIor), 20, -0.5f);
        world = worldOfQuads(std::move(scene), 4);
        fillWithLookups(world, 3, 2);
        traceable.emplace(world);
        bvh = buildSceneBvh(world.scene);
        settings.width = 64;
        settings.height = 48;
        settings.camera = lookAtCamera({0.3f, 1, 1}, {-0.2f, 0, 0}, 40);
        settings.samplesPerPixel = 1;
    }

    Image draw(Reflections reflections) {
        SilentProgress silent;
        const TracedReflections traced{traceable->scene, reflections, silent};
        Renderer renderer(world.input(), kShaderFolder);
        PictureSum sum;
        drawFrame(renderer, settings, &traced, sum);
        return readMean(sum);
    }

    Image drawByGpu() {
        Renderer renderer({world.scene, world.atlas, world.points, world.phatexture, &bvh}, kShaderFolder);
        FrameSettings traced = settings;
        traced.tracedByGpu = Reflections::automatic;
        return renderer.render(traced);
    }

    // Radiance of the ceiling that a pixel's mirror direction leads to, and its cosine; 0 near an edge.
    std::pair<float, float> mirrored(int x, int y) const {
        const glm::vec3 eye(settings.camera.worldFromCamera[3]);
        const glm::vec3 d = pixelDirection(settings.camera, x, y, settings.width, settings.height);
        if (d.y > -0.1f) return {0, 0};
        const glm::vec3 floor = eye - eye.y / d.y * d;
        const glm::vec3 seen = floor + 2 / -d.y * glm::vec3(d.x, -d.y, d.z);
        const float farthest =
            std::max({std::abs(floor.x), std::abs(floor.z), std::abs(seen.x), std::abs(seen.z)});
        if (farthest > 3.9f || std::abs(seen.x) < 0.05f) return {0, 0};
        return {seen.x < 0 ? 1.0f : 9.0f, -d.y};
    }

    RendererWorld world;
    std::optional<WorldOfRays> traceable;
    SceneBvh bvh;
    FrameSettings settings;
};

const Reflections kKinds[] = {Reflections::automatic, Reflections::rays};

TEST(TracedGlass, MirrorsWhatTheReflectedRayMeets) {
    const HeadlessContext context;
    PaneUnderCeiling pane(1);
    for (int kind = 0; kind < 3; ++kind) {
        const Image image = kind == 2 ? pane.drawByGpu() : pane.draw(kKinds[kind]);
        int dark = 0, bright = 0, wrong = 0;
        for (int y = 0; y < image.height; ++y) {
            for (int x = 0; x < image.width; ++x) {
                const auto [radiance, cosine] = pane.mirrored(x, y);
                if (radiance == 0) continue;
                const float r = specularAlbedo(glm::vec3(kF0), 1, kMinAlpha, cosine).x;
                wrong += std::abs(image.at(x, y).x - (r * radiance + (1 - r) * kBelow)) > 0.05f;
                ++(radiance < 5 ? dark : bright);
            }
        }
        EXPECT_GT(dark, 200);
        EXPECT_GT(bright, 200);
        // GGX has long tails: of a mirror's rays one in a thousand leaves by more than 3 degrees.
        EXPECT_LT(wrong, 0.01 * (dark + bright));
    }
}

// With rays, only what the nearest pane reflects is another than by the lookup, although a pane below covers
// the same pixels.
TEST(TracedGlass, RaysAreOfTheNearestPaneAlone) {
    const HeadlessContext context;
    PaneUnderCeiling panes(2);
    const Image lookedUp = panes.draw(Reflections::lookup);
    for (const Image& traced : {panes.draw(Reflections::automatic), panes.drawByGpu()}) {
        int compared = 0, wrong = 0;
        for (int y = 0; y < traced.height; ++y) {
            for (int x = 0; x < traced.width; ++x) {
                const auto [radiance, cosine] = panes.mirrored(x, y);
                if (radiance == 0) continue;
                const float r = specularAlbedo(glm::vec3(kF0), 1, kMinAlpha, cosine).x, t = 1 - r;
                const float pyramid = (lookedUp.at(x, y).x - t * t * kBelow) / (r + t * r);
                wrong += std::abs(traced.at(x, y).x - lookedUp.at(x, y).x - r * (radiance - pyramid)) > 0.05f;
                ++compared;
            }
        }
        EXPECT_GT(compared, 400);
        EXPECT_LT(wrong, 0.01 * compared);
    }
}

TEST(TracedGlass, NothingIsTracedWithoutGlassInView) {
    const HeadlessContext context;
    PaneUnderCeiling pane(1);
    Renderer renderer(pane.world.input(), kShaderFolder);
    PictureSum sum;
    EXPECT_GT(renderer.beginSample(pane.settings, Reflections::automatic, sum).panes.size(), 1000u);
    EXPECT_EQ(renderer.beginSample(pane.settings, Reflections::lookup, sum).panes.size(), 0u);
    pane.settings.camera = lookAtCamera({0.3f, 1, 1}, {0.3f, 3, 1.1f}, 40);
    EXPECT_EQ(renderer.beginSample(pane.settings, Reflections::automatic, sum).panes.size(), 0u);
}

}  // namespace
}  // namespace phat::test
