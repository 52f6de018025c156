// The scene as it is now against the scene at rest.

#include "core/dynamic/dynamic_scene.h"

#include "core/bake/bake.h"
#include "support/moving_room.h"

namespace phat {
namespace {

using namespace test;

TEST(DynamicScene, MaterialsBeyondTheStatesEndAreAsAtRest) {
    const Scene rest = roomWithBox();
    const Bake baked = bakeQuietly(rest);
    PosedScene posed(rest);
    DynamicScene scene(posed.snapshot(), baked.atlas, baked.points);
    SceneState state = stateOf(rest);
    state.materials.back().roughness = 0.321f;
    EXPECT_TRUE(scene.set(posedAs(posed, state)).materials);
    EXPECT_EQ(scene.scene().materials.back().roughness, 0.321f);
    state.materials.resize(1);
    EXPECT_TRUE(scene.set(posedAs(posed, state)).materials);
    EXPECT_EQ(scene.scene().materials, rest.materials);
    state.materials.clear();
    EXPECT_FALSE(scene.set(posedAs(posed, state)));
}

TEST(DynamicScene, AChangedLightLeavesTheBoxesOfWhatItReaches) {
    const Scene rest = roomWithBox();
    const Bake baked = bakeQuietly(rest);
    PosedScene posed(rest);
    DynamicScene scene(posed.snapshot(), baked.atlas, baked.points);
    SceneState state = stateOf(rest);
    state.lights[0].rangeMeters = 0.25f;
    const ChangedParts changed = scene.set(posedAs(posed, state));
    EXPECT_TRUE(changed.lights);
    EXPECT_FALSE(changed.nodes || changed.materials);
    // It reached everything before, and its range now.
    ASSERT_EQ(scene.changes().size(), 2u);
    const Bounds whole = boundsOf(rest);
    EXPECT_EQ(scene.changes()[0].kind, SceneChange::Kind::wholeScene);
    EXPECT_EQ(scene.changes()[0].box.low, whole.low);
    EXPECT_EQ(scene.changes()[0].box.high, whole.high);
    EXPECT_EQ(scene.changes()[1].kind, SceneChange::Kind::lightRange);
    EXPECT_EQ(scene.changes()[1].box.low, rest.lights[0].position - 0.25f);
    EXPECT_EQ(scene.changes()[1].box.high, rest.lights[0].position + 0.25f);
    // However often the light flickers, the boxes stay few, and they are of the last change.
    for (int i = 0; i < 100; ++i) {
        state.lights[0].intensity *= 1.01f;
        ASSERT_TRUE(scene.set(posedAs(posed, state)).lights);
    }
    EXPECT_LE(scene.changes().size(), 2u);
    EXPECT_EQ(scene.changes().back().version, scene.version());
}

}  // namespace
}  // namespace phat
