// Things that were not in the bake, drawn beside it.

#include <gtest/gtest.h>

#include "core/probes/light_probes.h"
#include "core/scene/occluders.h"
#include "gl/renderer_world.h"

namespace phat::test {
namespace {

/// Light that is the same everywhere, by normal.
LightProbes evenProbes(const IrradianceSh& indirect, const IrradianceSh& area) {
    LightProbes probes;
    probes.lowWorld = glm::vec3(-2);
    probes.cellMeters = glm::vec3(4);
    probes.gridSize = {1, 1, 1};
    probes.cells.emplace_back().fill(0);
    probes.places = {0};
    probes.indirect = {packIrradianceSh(indirect)};
    probes.area = {packIrradianceSh(area)};
    probes.distances.resize(1);
    return probes;
}

/// A floor that was baked, and beside it a quad that was not, at the height .5, seen from above.
struct AddedQuad : ::testing::Test {
    HeadlessContext context;
    RendererWorld world;
    Scene thing;
    IrradianceSh indirect, area;
    Camera camera = lookAtCamera({0, 3, 0.01f}, {0, 0, 0}, 45);

    Image draw(Component component = Component::all) {
        if (world.scene.surfaces.empty()) {
            Scene scene;
            addFloor(scene, lambert(0.5f), 2);
            scene.lights = lights;
            world = worldOfQuads(std::move(scene), 4);
            fillPhatexels(world, 0, [&](glm::vec3, glm::vec3) { return glm::vec3(floorRadiance); });
            world.phatexture.indirectIrradiance.assign(world.atlas.texelCount(),
                                                       packRgb9e5(glm::vec3(kPi * floorRadiance)));
        }
        const LightProbes probes = evenProbes(indirect, area);
        const AddedThings things{thing, probes};
        RendererInput input = world.input();
        if (!thing.triangles.empty()) input.added = &things;
        Renderer renderer(input, kShaderFolder);
        FrameSettings settings;
        settings.width = settings.height = 64;
        settings.camera = camera;
        settings.component = component;
        settings.samplesPerPixel = 1;
        return renderer.render(settings);
    }
    void addThing(const Material& material, float size = 0.6f) { addFloor(thing, material, size, 0.5f); }
    std::vector<PunctualLight> lights;
    float floorRadiance = 0;  // arriving at the floor from everywhere
};

TEST_F(AddedQuad, IsLitByTheProbes) {
    indirect.addLight({0, 1, 0}, glm::vec3(2, 1, 0.5f));
    area.addLight({0, 0.6f, 0.8f}, glm::vec3(1));
    addThing(lambert(0.8f));
    const glm::vec3 up(0, 1, 0);
    const glm::vec3 ofIndirect = 0.8f / kPi * indirect.at(up), ofArea = 0.8f / kPi * area.at(up);
    const std::pair<Component, glm::vec3> parts[] = {{Component::all, ofIndirect + ofArea},
                                                     {Component::direct, ofArea},
                                                     {Component::diffuseIndirect, ofIndirect},
                                                     {Component::glossyIndirect, glm::vec3(0)}};
    for (const auto& [component, want] : parts) {
        const glm::vec3 drawn = draw(component).at(32, 32);
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(drawn[c], want[c], 0.02f * (ofIndirect + ofArea)[c]);
    }
    // The floor that was baked dark is beside it.
    EXPECT_EQ(draw().at(5, 32), glm::vec3(0));
}

// Of a metal: the irradiance of a surface that faces where the mirror shows, over pi.
TEST_F(AddedQuad, ReflectsTheProbesBlurred) {
    indirect.addLight(glm::normalize(glm::vec3(0, 1, -2)), glm::vec3(2));
    camera = lookAtCamera({0, 2.5f, 2}, {0, 0.5f, 0}, 20);
    const glm::vec3 mirror = glm::normalize(glm::vec3(0, 1, -1));
    const Material gold = metal(0.1f);
    addThing(gold);
    const glm::vec3 drawn = draw(Component::glossyIndirect).at(32, 32);
    const glm::vec3 want = glm::vec3(gold.baseColor) * indirect.at(mirror) / kPi;
    // Smooth microfacets hide little of each other.
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(drawn[c], want[c], 0.03f * want.x);
    EXPECT_EQ(draw(Component::diffuseIndirect).at(32, 32), glm::vec3(0));
}

// In the light of a lamp above it, which it keeps from the floor below it.
TEST_F(AddedQuad, CastsAShadow) {
    lights = {pointLight(glm::vec3(3), {0, 1, 0})};
    const float without = draw().at(32, 41).x;
    EXPECT_GT(without, 0.01f);
    addThing(lambert(0.8f), 0.4f);
    const Image with = draw();
    EXPECT_NEAR(with.at(32, 32).x, 0.8f / kPi * 3 / square(0.5f), 0.02f);
    EXPECT_LT(with.at(32, 41).x, 0.05f * without) << "in its shadow";
    EXPECT_NEAR(with.at(32, 60).x, draw().at(32, 60).x, 1e-4f);
}

// What it keeps of the baked light from the floor is what the ellipsoid that stands for it does.
TEST_F(AddedQuad, ThrowsAContactShadow) {
    floorRadiance = 1;
    const Image without = draw(Component::diffuseIndirect);
    addOutwardBox(thing, lambert(0.8f), {-0.2f, 0, -0.2f}, {0.4f, 0.4f, 0.4f});
    const std::vector<Occluder> occluders = occludersOf(thing);
    ASSERT_EQ(occluders.size(), 1u);
    const Image with = draw(Component::diffuseIndirect);
    const glm::vec3 eye(camera.worldFromCamera[3]);
    for (const int x : {8, 12, 16, 20, 44, 50}) {
        EXPECT_NEAR(without.at(x, 32).x, 0.5f, 0.01f);
        const glm::vec3 direction = pixelDirection(camera, x, 32, 64, 64);
        const glm::vec3 floor = eye - eye.y / direction.y * direction;
        const float left = 1 - occlusionBy(occluders[0], floor, {0, 1, 0});
        EXPECT_LT(left, 0.99f);
        EXPECT_NEAR(with.at(x, 32).x, left * without.at(x, 32).x, 0.005f) << x;
    }
}

TEST_F(AddedQuad, ShowsItsEmissionAndIsHidden) {
    addThing(emitter(glm::vec3(0.25f, 0.5f, 1)));
    EXPECT_NEAR(draw().at(32, 32).y, 0.5f, 1e-3f);
    thing = {};
    addFloor(thing, emitter(glm::vec3(1)), 0.6f, -0.5f);  // under the floor
    EXPECT_EQ(draw().at(32, 32), glm::vec3(0));
}

// The lamp is between the two: it lights the floor alone.
TEST_F(AddedQuad, IsBlendedOverWhatIsBehind) {
    lights = {pointLight(glm::vec3(0.3f), {0, 0.3f, 0})};
    const float floor = draw().at(32, 32).x;
    EXPECT_GT(floor, 0.3f);
    Material veil = emitter(glm::vec3(1));
    veil.alphaMode = AlphaMode::blend;
    veil.baseColor.a = 0.25f;
    addThing(veil);
    EXPECT_NEAR(draw().at(32, 32).x, 0.25f + 0.75f * floor, 0.01f);
}

}  // namespace
}  // namespace phat::test
