// Light that is added to a scene, and what a file says of it.

#include "io/phat/scene_lighting.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "support/scene_builder.h"

namespace phat {
namespace {

using namespace test;

Scene yard() {
    Scene scene;
    addFloor(scene, lambert(0.5f), 4);
    addQuad(scene, lambert(0.7f), {-0.5f, 0, 0}, {1, 0, 0}, {0, 1, 0});
    return scene;
}

TEST(SceneLighting, TheBvhThatWasBuiltIsPassedOn) {
    Scene dark = yard();
    const AddedLighting sky = addLighting({}, dark);
    ASSERT_NE(sky.bvh, nullptr);
    EXPECT_EQ(raysOf(dark, sky).bvh(), sky.bvh);
    EXPECT_NEAR(raysOf(dark, sky).closestHit({0.2f, 2, 0.5f}, {0, -1, 0}).distance, 2, 1e-5f);

    Scene lit = yard();
    lit.lights.push_back(pointLight(glm::vec3(1), {0, 2, 0}));
    const AddedLighting nothing = addLighting({}, lit);
    EXPECT_EQ(nothing.bvh, nullptr) << "nothing had to be asked";
    EXPECT_NEAR(raysOf(lit, nothing).closestHit({0.2f, 2, 0.5f}, {0, -1, 0}).distance, 2, 1e-5f);
}

TEST(SceneLighting, AFilesAddedSunIsADiscAndItsOthersAreNot) {
    Scene scene = yard();
    SceneLighting asked;
    asked.sky = SkyChoice::given;
    addLighting(asked, scene);
    ASSERT_EQ(scene.lights.size(), 1u);
    EXPECT_EQ(scene.lights[0].angularRadius, kSunAngularRadius);

    nlohmann::json gltf = {{"nodes", nlohmann::json::array()}};
    writeAddedLights(scene, gltf);
    gltf["nodes"].push_back({{"name", "a directional light of the file"}});
    gltf["nodes"].push_back({{"extras", "text"}});
    Scene read = scene;
    read.lights[0].angularRadius = 0;
    read.lights.push_back(directionalLight(glm::vec3(1), {0, -1, 0}));
    read.lights.push_back(read.lights[1]);
    read.lights.push_back(pointLight(glm::vec3(1), {}));
    for (uint32_t i = 0; i < 3; ++i) read.lights[i].node = i;
    read.lights[3].node = 0;
    restoreAddedLights(gltf, read);
    EXPECT_EQ(read.lights[0].angularRadius, kSunAngularRadius);
    for (size_t i = 1; i < 4; ++i) EXPECT_EQ(read.lights[i].angularRadius, 0);
}

}  // namespace
}  // namespace phat
