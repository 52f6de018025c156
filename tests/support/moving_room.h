#pragma once
// A room in which things move, for the tests of the incremental baker.

#include <gtest/gtest.h>

#include <cstring>
#include <glm/gtc/matrix_transform.hpp>

#include "core/bake/bake.h"
#include "core/base/random.h"
#include "core/dynamic/dynamic_scene.h"
#include "support/scene_builder.h"

namespace phat::test {

inline constexpr uint32_t kBoxNode = 1, kLampNode = 2;

// A room, a coloured box on its floor, a lamp's panel and a point light.
inline Scene roomWithBox() {
    Scene scene;
    addRoom(scene, lambert(0.6f), {1, 1, 1});
    scene.materials[0].baseColor = {0.8f, 0.2f, 0.2f, 1};
    Material metal = lambert(0.7f);
    metal.metallic = 1;
    metal.roughness = 0.4f;
    scene.materials[scene.surfaces[2].material] = metal;  // the floor
    const size_t room = scene.surfaces.size();
    const glm::vec3 low(0.2f, 0, 0.2f), high(0.45f, 0.3f, 0.4f);
    for (int axis = 0; axis < 3; ++axis) {
        glm::vec3 along(0), across(0), far = low;
        along[(axis + 1) % 3] = high[(axis + 1) % 3] - low[(axis + 1) % 3];
        across[(axis + 2) % 3] = high[(axis + 2) % 3] - low[(axis + 2) % 3];
        far[axis] = high[axis];
        addQuad(scene, lambert(0.5f), low, across, along);
        addQuad(scene, lambert(0.5f), far, along, across);
    }
    for (size_t s = room; s < scene.surfaces.size(); ++s) {
        scene.surfaces[s].node = kBoxNode;
        scene.materials[scene.surfaces[s].material].baseColor = {0.2f, 0.7f, 0.3f, 1};
    }
    addQuad(scene, emitter(glm::vec3(4), 0.5f), {0.3f, 0.98f, 0.3f}, {0.4f, 0, 0}, {0, 0, 0.4f});
    scene.surfaces.back().node = kLampNode;
    scene.lights = {pointLight(glm::vec3(0.3f), {0.7f, 0.6f, 0.6f})};
    scene.lights[0].node = kLampNode;
    return scene;
}

inline BakeSettings smallBake() {
    BakeSettings settings;
    settings.atlas.texelBudget = 30'000;
    settings.photons.count = 20'000;
    settings.pathsPerPhatexel = 2;
    return settings;
}

inline Bake bakeQuietly(const Scene& scene) {
    SilentProgress progress;
    return bake(scene, smallBake(), progress);
}

inline SceneState stateOf(const Scene& scene) {
    return {{}, scene.lights, scene.materials};
}

/// What a scene is once it has been brought to `state`.
inline SharedSnapshot posedAs(PosedScene& posed, const SceneState& state) {
    posed.setState(state);
    return posed.snapshot();
}

inline SceneState boxMoved(const Scene& scene, glm::vec3 by, float degrees) {
    SceneState state = stateOf(scene);
    const glm::vec3 middle(0.325f, 0, 0.3f);
    glm::mat4 m = glm::translate(glm::mat4(1), by + middle);
    m = glm::rotate(m, glm::radians(degrees), glm::vec3(0, 1, 0));
    state.worldFromRest = {glm::mat4(1), glm::translate(m, -middle)};
    return state;
}

/// Moves, removals to the far end, lamps switched, paint.
inline SceneState randomState(const Scene& scene, Rng& rng) {
    SceneState state =
        boxMoved(scene, {0.5f * rng.uniform() - 0.2f, 0.1f * rng.uniform(), 0.5f * rng.uniform() - 0.2f},
                 360.0f * rng.uniform());
    if (rng.uniform() < 0.1f) state.worldFromRest[kBoxNode] = glm::translate(glm::mat4(1), glm::vec3(50));
    if (rng.uniform() < 0.3f)
        state.worldFromRest.push_back(
            glm::translate(glm::mat4(1), {0.2f * rng.uniform(), -0.3f * rng.uniform(), 0}));
    if (rng.uniform() < 0.3f) state.lights.clear();
    if (rng.uniform() < 0.3f) state.materials.back().emission = glm::vec3(8 * rng.uniform());
    if (rng.uniform() < 0.3f)
        state.materials.front().baseColor = {rng.uniform(), rng.uniform(), rng.uniform(), 1};
    return state;
}

template <typename Value>
void expectEqualBytes(const std::vector<Value>& a, const std::vector<Value>& b, const char* what) {
    ASSERT_EQ(a.size(), b.size()) << what;
    size_t different = 0;
    for (size_t i = 0; i < a.size(); ++i) different += std::memcmp(&a[i], &b[i], sizeof(Value)) != 0;
    EXPECT_EQ(different, 0u) << what << " of " << a.size();
}

inline void expectEqual(const Phatexture& a, const Phatexture& b) {
    expectEqualBytes(a.areaIrradiance, b.areaIrradiance, "area irradiance");
    expectEqualBytes(a.indirectIrradiance, b.indirectIrradiance, "indirect irradiance");
    expectEqualBytes(a.indirectGuides, b.indirectGuides, "guides");
    expectEqualBytes(a.areaGuides, b.areaGuides, "area guides");
    expectEqualBytes(a.probes, b.probes, "distances");
    ASSERT_EQ(a.indirect.size(), b.indirect.size());
    for (size_t l = 0; l < a.indirect.size(); ++l)
        expectEqualBytes(a.indirect[l].texels, b.indirect[l].texels, "PHATexels");
    ASSERT_EQ(a.area.size(), b.area.size());
    for (size_t l = 0; l < a.area.size(); ++l)
        expectEqualBytes(a.area[l].texels, b.area[l].texels, "area PHATexels");
}

}  // namespace phat::test
