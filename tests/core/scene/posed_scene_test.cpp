// The scene as it is now, and the snapshots of it that others read.

#include "core/scene/posed_scene.h"

#include <gtest/gtest.h>

#include <glm/gtc/matrix_transform.hpp>
#include <thread>

#include "support/scene_builder.h"

namespace phat {
namespace {

using namespace test;

constexpr uint32_t kPanelNode = 1;

// A textured panel of one node in a room under a sky, and a lamp on the panel.
Scene roomWithPanel() {
    Scene scene;
    addRoom(scene, lambert(0.6f), {1, 1, 1});
    Material textured = lambert(0.5f);
    textured.doubleSided = true;
    textured.baseColorTexture.image = 0;
    scene.images.push_back(TextureImage{"checker", 2, 1, {{255, 0, 0, 255}, {0, 255, 0, 255}}});
    addQuad(scene, textured, {0.3f, 0.5f, 0.3f}, {0.4f, 0, 0}, {0, 0, 0.4f});
    scene.surfaces.back().node = kPanelNode;
    scene.lights = {pointLight(glm::vec3(1), {0.5f, 0.7f, 0.5f})};
    scene.lights[0].node = kPanelNode;
    Image sky(4, 2);
    for (size_t i = 0; i < sky.pixels.size(); ++i) sky.pixels[i] = glm::vec3(float(i));
    scene.environment = Environment{sky};
    return scene;
}

SceneState stateOf(const Scene& scene) {
    return {{}, scene.lights, scene.materials};
}

SceneState raised(const Scene& scene, float meters) {
    SceneState state = stateOf(scene);
    state.worldFromRest = {glm::mat4(1), glm::translate(glm::mat4(1), {0, meters, 0})};
    return state;
}

float distanceToPanel(const SceneSnapshot& snapshot) {
    return snapshot.rays().closestHit({0.5f, 0.1f, 0.5f}, {0, 1, 0}).distance;
}

bool sameBvh(const SceneSnapshot& a, const SceneSnapshot& b) {
    return a.rays().bvh() == b.rays().bvh();
}

TEST(PosedScene, TellsWhatAStateChanges) {
    PosedScene posed(roomWithPanel());
    const Scene rest = posed.rest();
    EXPECT_FALSE(posed.setState(stateOf(rest)));

    const ChangedParts moved = posed.setState(raised(rest, 0.1f));
    EXPECT_TRUE(moved.nodes && moved.lights);  // the lamp is on the panel
    EXPECT_FALSE(moved.materials || moved.environment);
    EXPECT_FALSE(posed.setState(raised(rest, 0.1f)));

    SceneState state = raised(rest, 0.1f);
    state.materials.back().roughness = 0.3f;
    const ChangedParts painted = posed.setState(state);
    EXPECT_TRUE(painted.materials);
    EXPECT_FALSE(painted.nodes || painted.lights || painted.environment);

    state.environmentColumns = 1;
    const ChangedParts turnedSky = posed.setState(state);
    EXPECT_TRUE(turnedSky.environment);
    EXPECT_FALSE(turnedSky.nodes || turnedSky.lights || turnedSky.materials);
    EXPECT_EQ(posed.scene().environment->radiance.at(1, 0), rest.environment->radiance.at(0, 0));
    state.environmentColumns = 3;
    posed.setState(state);
    EXPECT_EQ(posed.scene().environment->radiance.at(3, 0), rest.environment->radiance.at(0, 0));
}

TEST(PosedScene, OnlyMotionAndTransparencyNeedAnotherAccelerationStructure) {
    PosedScene posed(roomWithPanel());
    const Scene rest = posed.rest();
    const SharedSnapshot atRest = posed.snapshot();
    SceneState state = stateOf(rest);
    state.materials[0].roughness = 0.123f;
    state.lights[0].intensity *= 2.0f;
    state.environmentColumns = 1;
    ASSERT_TRUE(posed.setState(state));
    EXPECT_TRUE(sameBvh(*posed.snapshot(), *atRest));
    // Nevertheless its rays ask the materials of their own scene.
    EXPECT_EQ(&posed.snapshot()->rays().scene(), &posed.scene());

    posed.setState(raised(rest, 0.2f));
    const SharedSnapshot up = posed.snapshot();
    EXPECT_FALSE(sameBvh(*up, *atRest));
    EXPECT_NEAR(distanceToPanel(*up), 0.6f, 1e-5f);

    state = raised(rest, 0.2f);
    state.materials.back().alphaMode = AlphaMode::mask;
    state.materials.back().baseColor.a = 0;
    posed.setState(state);
    const SharedSnapshot cut = posed.snapshot();
    EXPECT_FALSE(sameBvh(*cut, *up));
    EXPECT_NEAR(distanceToPanel(*cut), 0.9f, 1e-5f);
    // Among transparent ones it is shared again, and each asks its own materials.
    state.materials.back().baseColor.a = 1;
    posed.setState(state);
    EXPECT_TRUE(sameBvh(*posed.snapshot(), *cut));
    EXPECT_NEAR(distanceToPanel(*posed.snapshot()), 0.6f, 1e-5f);
    EXPECT_NEAR(distanceToPanel(*cut), 0.9f, 1e-5f);
}

TEST(PosedScene, ASnapshotStaysAsItIs) {
    PosedScene posed(roomWithPanel());
    const Scene rest = posed.rest();
    posed.setState(raised(rest, 0.1f));
    const SharedSnapshot kept = posed.snapshot();
    const Scene before = kept->scene();
    // A reader on its own thread, which asks while the scene goes on changing; the rays are built there.
    float onThread = 0;
    std::thread reader([&, kept] { onThread = distanceToPanel(*kept); });
    for (int i = 2; i < 20; ++i) {
        SceneState state = raised(rest, 0.01f * float(i));
        state.lights.clear();
        state.materials.back().metallic = 0.05f * float(i);
        state.environmentColumns = i;
        ASSERT_TRUE(posed.setState(state));
    }
    reader.join();
    EXPECT_NEAR(onThread, 0.5f, 1e-5f);
    EXPECT_NEAR(distanceToPanel(*posed.snapshot()), 0.59f, 1e-5f);
    EXPECT_EQ(kept->scene().positions, before.positions);
    EXPECT_EQ(kept->scene().normals, before.normals);
    EXPECT_EQ(kept->scene().materials, before.materials);
    EXPECT_EQ(kept->scene().lights, before.lights);
    EXPECT_EQ(kept->scene().environment->radiance.pixels, before.environment->radiance.pixels);
}

TEST(PosedScene, TexturesAndTheUnturnedSkyAreHeldOnce) {
    PosedScene posed(roomWithPanel());
    const SharedSnapshot atRest = posed.snapshot();
    SceneState state = raised(posed.rest(), 0.1f);
    state.materials.back().roughness = 0.2f;
    posed.setState(state);
    ASSERT_NE(&posed.scene(), &posed.rest());
    ASSERT_EQ(posed.scene().images.size(), 1u);
    EXPECT_EQ(&*posed.scene().images[0], &*atRest->scene().images[0]);
    EXPECT_EQ(posed.scene().images[0]->texels.data(), posed.rest().images[0]->texels.data());
    EXPECT_EQ(&*posed.scene().environment, &*posed.rest().environment);
}

TEST(PosedScene, BackAtRestThereIsOneScene) {
    PosedScene posed(roomWithPanel());
    const Scene rest = posed.rest();
    const SharedSnapshot first = posed.snapshot();
    EXPECT_EQ(posed.snapshotAtRest(), first);
    SceneState state = raised(rest, 0.1f);
    state.environmentColumns = 2;
    posed.setState(state);
    EXPECT_EQ(&posed.snapshotAtRest()->scene(), &posed.rest());
    EXPECT_TRUE(posed.snapshotAtRest()->worldFromRest().empty());
    EXPECT_NEAR(distanceToPanel(*posed.snapshotAtRest()), 0.4f, 1e-5f);
    posed.setState(stateOf(rest));
    EXPECT_EQ(&posed.scene(), &posed.rest());
    EXPECT_NEAR(distanceToPanel(*posed.snapshot()), 0.4f, 1e-5f);
}

}  // namespace
}  // namespace phat
