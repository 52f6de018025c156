// Rays of the GPU through glass, and from it, against closed forms and the CPU's rays.

#include <gtest/gtest.h>

#include "core/scene/brdf.h"
#include "gl/traced_frame.h"
#include "gl/traced_world.h"
#include "support/glass_scenes.h"

namespace phat::test {
namespace {

constexpr float kReflected = 2;  // radiance that surfaces reflect sharply, if their irradiance is not 0

Material tinted(Material glass) {
    glass.baseColor = glm::vec4(0.9f, 0.6f, 0.3f, 1);
    return glass;
}

/// Drawn by the GPU's rays, and by the CPU's.
struct GlassWorld {
    explicit GlassWorld(Scene scene)
        : world(worldOfQuads(std::move(scene), 4)), bvh(buildSceneBvh(world.scene)), traceable(world) {
        fillWithLookups(world, kReflected, 0);
        frame.width = 32;
        frame.height = 24;
        frame.camera = lookAtCamera({0, 1, 1}, {0.1f, 0, 0}, 2);
        frame.samplesPerPixel = 64;
        frame.rays.lightSamples = 1;
    }

    Image byGpu() {
        Renderer renderer({world.scene, world.atlas, world.points, world.phatexture, &bvh}, kShaderFolder);
        FrameSettings traced = frame;
        traced.tracedByGpu = Reflections::rays;
        return renderer.render(traced);
    }
    Image byCpu() {
        SilentProgress silent;
        const TracedReflections traced{traceable.scene, Reflections::rays, silent};
        Renderer renderer(world.input(), kShaderFolder);
        PictureSum sum;
        drawFrame(renderer, frame, &traced, sum);
        return readMean(sum);
    }

    HeadlessContext context;
    RendererWorld world;
    SceneBvh bvh;
    WorldOfRays traceable;
    FrameSettings frame;
};

glm::dvec3 meanOf(const Image& image) {
    glm::dvec3 sum(0);
    for (const glm::vec3& pixel : image.pixels) sum += glm::dvec3(pixel);
    return sum / double(image.pixels.size());
}

void expectNear(glm::dvec3 found, glm::dvec3 expected, double relative, const char* what) {
    for (int i = 0; i < 3; ++i)
        EXPECT_NEAR(found[i], expected[i], relative * expected[i]) << what << ' ' << i;
}

TEST(GpuGlass, MirrorShowsWhatIsBehindAPane) {
    Scene scene = floorAndCeiling(whiteMetal(0), lambert(0.5f));
    addFloor(scene, tinted(glass()), 8, 1.5f);
    GlassWorld glassy(std::move(scene));
    setIrradiance(glassy.world, 1, 3);
    glassy.frame.component = Component::glossyIndirect;
    const float cosine = 1 / glm::length(glm::vec3(0.1f, 1, 1));
    const glm::vec3 passed = (1 - specularAlbedo(glm::vec3(0.04f), 1, kMinAlpha, cosine).x) *
                             glm::vec3(glassy.world.scene.materials[2].baseColor);
    expectNear(meanOf(glassy.byGpu()), glm::dvec3(passed) * (0.5 * 3 / double(kPi)), 0.01, "tinted");
}

// A pane that the ray does not pass shows what it reflects.
TEST(GpuGlass, PanesReflectWhatTheyDoNotTransmit) {
    Scene scene = floorAndCeiling(whiteMetal(0), lambert(0));
    addCeiling(scene, tinted(glass(11)), 8, 1.5f);
    GlassWorld glassy(std::move(scene));
    setIrradiance(glassy.world, 2, 3);
    glassy.frame.component = Component::glossyIndirect;
    const float cosine = 1 / glm::length(glm::vec3(0.1f, 1, 1));
    const double reflected = double(specularAlbedo(glm::vec3(100 / 144.0f), 1, kMinAlpha, cosine).x);
    expectNear(meanOf(glassy.byGpu()), glm::dvec3(reflected * double(kReflected)), 0.02, "reflected");
}

TEST(GpuGlass, AppearsAndDisappearsByAChangeOfMaterial) {
    Scene scene = floorAndCeiling(whiteMetal(0), lambert(0.5f));
    addCeiling(scene, lambert(0), 8, 1.5f);
    GlassWorld glassy(std::move(scene));
    setIrradiance(glassy.world, 1, 3);
    glassy.frame.component = Component::glossyIndirect;
    glassy.frame.tracedByGpu = Reflections::rays;
    const Scene& opaque = glassy.world.scene;
    Renderer renderer({opaque, glassy.world.atlas, glassy.world.points, glassy.world.phatexture, &glassy.bvh},
                      kShaderFolder);
    const auto shown = [&] { return meanOf(renderer.render(glassy.frame)).x; };
    EXPECT_NEAR(shown(), 0, 1e-3);
    std::vector<Material> materials = opaque.materials;
    materials[opaque.surfaces[2].material] = glass(1);
    renderer.setMaterials(materials);
    EXPECT_NEAR(shown(), 0.5 * 3 / double(kPi), 0.01);
    renderer.setMaterials(opaque.materials);
    EXPECT_NEAR(shown(), 0, 1e-3);
}

/// A floor under two panels, and glass between them.
struct Case {
    const char* name;
    float roughness;  // of the floor
    Material material;
    bool isBox;
};

Scene glassOver(const Case& c) {
    Scene scene = mirrorUnderTwoPanels();
    scene.materials[scene.surfaces[0].material] = whiteMetal(c.roughness);
    // Seen by nobody: with it no clamp to the brightest light hides what is too bright.
    addQuad(scene, emitter(glm::vec3(1e4f)), {0, 5, 0}, {0, 0, 0.01f}, {0.01f, 0, 0});
    if (!c.isBox) {
        addFloor(scene, c.material, 6, 1.2f);
        return scene;
    }
    // Tilted, so that what is behind it moves.
    const glm::vec3 corner(-2, 1.2f, -3), x(4, 0.8f, 0), y(-0.1f, 0.4f, 0), z(0, 0, 3);
    const auto quad = [&](glm::vec3 at, glm::vec3 a, glm::vec3 b) {
        addQuad(scene, c.material, at, a, b);
        scene.surfaces.back().node = 7;
    };
    quad(corner, x, z);
    quad(corner + y, z, x);
    quad(corner, y, x);
    quad(corner + z, x, y);
    quad(corner, z, y);
    quad(corner + x, y, z);
    return scene;
}

TEST(GpuGlass, AgreesWithTheRaysOfTheCpu) {
    Material coloured = solidGlass();
    coloured.attenuationColor = {0.9f, 0.5f, 0.2f};
    coloured.attenuationDistance = 0.5f;
    Material thick = glass();
    thick.thickness = 0.02f;
    thick.attenuationColor = {0.2f, 0.5f, 0.9f};
    thick.attenuationDistance = 0.04f;
    for (const Case& c : {Case{"tinted pane, mirror", 0, tinted(glass()), false},
                          Case{"tinted pane, gloss", 0.3f, tinted(glass()), false},
                          Case{"tinted pane, rough floor", 0.7f, tinted(glass()), false},
                          Case{"rough pane, gloss", 0.2f, tinted(glass(1.5f, 0.4f)), false},
                          Case{"thick pane, gloss", 0.3f, thick, false},
                          Case{"box, mirror", 0, coloured, true}, Case{"box, gloss", 0.3f, coloured, true},
                          Case{"rough box, gloss", 0.2f, solidGlass(1.5f, 0.4f), true}}) {
        GlassWorld glassy(glassOver(c));
        glassy.frame.camera = lookAtCamera({0, 1, 1}, {0.1f, 0, 0}, 30);
        glassy.frame.component = Component::direct;
        const Image gpu = glassy.byGpu(), cpu = glassy.byCpu();
        expectNear(meanOf(gpu), meanOf(cpu), 0.015, c.name);
        double apart = 0;
        for (size_t i = 0; i < gpu.pixels.size(); ++i)
            apart += double(luminance(glm::abs(gpu.pixels[i] - cpu.pixels[i]))) / double(gpu.pixels.size());
        EXPECT_LT(apart, 0.08 * double(luminance(glm::vec3(meanOf(cpu))))) << c.name;
    }
}

}  // namespace
}  // namespace phat::test
