// Rough glass blurs what is behind it, as paths through it do.

#include <gtest/gtest.h>

#include <numeric>

#include "core/render/path_tracer.h"
#include "gl/renderer_world.h"
#include "support/glass_scenes.h"

namespace phat::test {
namespace {

constexpr int kSize = 64;
constexpr float kStep = 8;  // from an emitter of 1 on the left to one of 9 on the right

// Both screens end in the picture's middle, `behind` a pane or a slab.
Scene screensBehind(const Material& material, float behind) {
    Scene scene;
    if (material.thickness > 0)
        addOutwardBox(scene, material, {-3, -3, -0.02f}, {6, 6, 0.02f});
    else
        addQuad(scene, material, {-3, -3, 0}, {6, 0, 0}, {0, 6, 0});
    addQuad(scene, emitter(glm::vec3(1)), {-9, -9, -behind}, {9, 0, 0}, {0, 18, 0});
    addQuad(scene, emitter(glm::vec3(1 + kStep)), {0, -9, -behind}, {9, 0, 0}, {0, 18, 0});
    return scene;
}

// Means of columns over the middle rows.
std::vector<double> profileOf(const Image& image) {
    std::vector<double> profile(kSize);
    for (int x = 0; x < kSize; ++x)
        for (int y = kSize / 4; y < 3 * kSize / 4; ++y)
            profile[size_t(x)] += double(image.at(x, y).x) / (kSize / 2);
    return profile;
}

std::vector<double> traced(const Scene& scene, const Camera& camera) {
    const RayScene rays(scene);
    const LightSampler lights(scene);
    PictureSettings settings;
    settings.width = settings.height = kSize;
    settings.camera = camera;
    settings.samplesPerPixel = 64;
    SilentProgress silent;
    return profileOf(tracePicture(settings, pathTracer(rays, lights, Component::direct), silent).mean);
}

std::vector<double> drawn(Renderer& renderer, const Camera& camera) {
    FrameSettings settings;
    settings.width = settings.height = kSize;
    settings.camera = camera;
    settings.component = Component::direct;
    settings.samplesPerPixel = 16;
    return profileOf(renderer.render(settings));
}

double meanDifference(const std::vector<double>& a, const std::vector<double>& b) {
    double sum = 0;
    for (size_t i = 0; i < a.size(); ++i) sum += std::abs(a[i] - b[i]) / (double(a.size()) * kStep);
    return sum;
}

Camera camera(bool perspective) {
    Camera c = lookAtCamera({0, 0, 2}, {0, 0, 0}, 60);
    c.perspective = perspective;
    c.ymag = 1.2f;
    return c;
}

double sumOf(const std::vector<double>& profile) {
    return std::accumulate(profile.begin(), profile.end(), 0.0);
}

// A column's mean is of 2,048 paths, whose radiance has a standard deviation of at most half the step: .011
// of it near the border, and the mean over all columns is off by less. The blur is as wide as the paths' to a
// tenth; glass that is sharp is off by ten tenths.
TEST(RoughGlass, BlursAsPathsDo) {
    const HeadlessContext context;
    int wrongIfSharp = 0;
    for (const bool closed : {false, true}) {
        for (const float roughness : {0.25f, 0.5f}) {
            const Material material = closed ? solidGlass(1.5f, roughness) : glass(1.5f, roughness);
            for (const float behind : {0.1f, 0.6f, 2.0f}) {
                const Scene scene = screensBehind(material, behind);
                const RendererWorld world = worldOfQuads(scene, 2);
                Renderer renderer(world.input(), kShaderFolder);
                for (const bool perspective : {true, false}) {
                    SCOPED_TRACE(testing::Message()
                                 << closed << ' ' << roughness << ' ' << behind << ' ' << perspective);
                    const auto want = traced(scene, camera(perspective));
                    const auto differenceOf = [&](float drawnRoughness) {
                        std::vector<Material> materials = scene.materials;
                        for (Material& m : materials) m.roughness = drawnRoughness;
                        renderer.setMaterials(materials);
                        std::vector<double> got = drawn(renderer, camera(perspective));
                        // The inside of a rough slab reflects more than that of a smooth one, which the
                        // renderer's transmittance leaves out.
                        const double share = closed ? sumOf(want) / sumOf(got) : 1;
                        EXPECT_NEAR(share, 1, 0.1);
                        for (double& x : got) x *= share;
                        return meanDifference(got, want);
                    };
                    const double sharp = differenceOf(0), limit = 0.008 + 0.1 * sharp;
                    EXPECT_LT(differenceOf(roughness), limit);
                    wrongIfSharp += sharp > limit;
                }
            }
        }
    }
    EXPECT_GE(wrongIfSharp, 16);  // of 24
}

}  // namespace
}  // namespace phat::test
