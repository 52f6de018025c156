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
    DynamicScene scene(rest, baked.atlas, baked.points);
    SceneState state = stateOf(rest);
    state.materials.back().roughness = 0.321f;
    EXPECT_TRUE(scene.set(state).materials);
    EXPECT_EQ(scene.scene().materials.back().roughness, 0.321f);
    state.materials.resize(1);
    EXPECT_TRUE(scene.set(state).materials);
    EXPECT_EQ(scene.scene().materials, rest.materials);
    state.materials.clear();
    EXPECT_FALSE(scene.set(state));
}

}  // namespace
}  // namespace phat
