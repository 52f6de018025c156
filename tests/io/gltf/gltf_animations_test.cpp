#include <gtest/gtest.h>

#include "io/gltf/gltf_builder.h"
#include "io/gltf/gltf_loader.h"
#include "support/temporary_folder.h"

namespace phat {
namespace {

using test::GltfBuilder;
using Json = nlohmann::json;
using Path = AnimationChannel::Path;
using Interpolation = AnimationChannel::Interpolation;

LoadedScene load(const GltfBuilder& builder) {
    const TemporaryFolder folder;
    writeBytes(folder.file("a.glb"), builder.glb());
    return loadGltf(folder.file("a.glb"));
}

Json channel(int sampler, int node, const char* path) {
    return {{"sampler", sampler}, {"target", {{"node", node}, {"path", path}}}};
}

TEST(GltfAnimations, ChannelsOfAllKindsAreRead) {
    GltfBuilder builder;
    builder.root({{"name", "a"}, {"translation", {1, 2, 3}}, {"children", {1}}});
    builder.push("nodes", {{"name", "b"}, {"rotation", {0, 0, 0, 2}}});
    const int times = builder.floats("SCALAR", {0, 1.5f});
    const int translations = builder.floats("VEC3", {0, 0, 0, 1, 2, 3});
    // Normalised integers: x 32767 / 32767.
    const int turns = builder.accessor(builder.view<int16_t>({0, 0, 0, 32767, 32767, 0, 0, 0}), test::kShort,
                                       "VEC4", 2, true);
    const int spline = builder.floats("VEC3", std::vector<float>(18, 2.0f));
    builder.push(
        "animations",
        {{"name", "walk"},
         {"samplers",
          {{{"input", times}, {"output", translations}},
           {{"input", times}, {"output", turns}, {"interpolation", "STEP"}},
           {{"input", times}, {"output", spline}, {"interpolation", "CUBICSPLINE"}}}},
         {"channels", {channel(0, 0, "translation"), channel(1, 1, "rotation"), channel(2, 1, "scale")}}});
    const LoadedScene loaded = load(builder);
    EXPECT_TRUE(loaded.notes.empty());
    ASSERT_EQ(loaded.scene.nodes.size(), 2u);
    EXPECT_EQ(loaded.scene.nodes[1].parent, 0);
    EXPECT_EQ(loaded.scene.nodes[0].translation, glm::vec3(1, 2, 3));
    EXPECT_EQ(loaded.scene.nodes[1].rotation.w, 1.0f);
    ASSERT_EQ(loaded.scene.animations.size(), 1u);
    const Animation& walk = loaded.scene.animations[0];
    EXPECT_EQ(walk.name, "walk");
    EXPECT_EQ(walk.seconds(), 1.5f);
    ASSERT_EQ(walk.channels.size(), 3u);
    EXPECT_EQ(walk.channels[0].values[1], glm::vec4(1, 2, 3, 0));
    EXPECT_EQ(walk.channels[1].interpolation, Interpolation::step);
    EXPECT_EQ(walk.channels[1].values[1], glm::vec4(1, 0, 0, 0));
    EXPECT_EQ(walk.channels[2].path, Path::scale);
    EXPECT_EQ(walk.channels[2].values.size(), 6u);
}

// Each alone: the rest of the animation is played.
TEST(GltfAnimations, BadChannelsAreLeftOutAndNoted) {
    GltfBuilder good;
    good.root({{"name", "a"}});
    good.root({{"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}}});
    const int times = good.floats("SCALAR", {0, 1}), translations = good.floats("VEC3", {0, 0, 0, 1, 2, 3});
    const int backward = good.floats("SCALAR", {1, 1}),
              infinite = good.floats("VEC3", {0, 0, INFINITY, 1, 2, 3});
    good.push("animations", {{"samplers",
                              {{{"input", times}, {"output", translations}},
                               {{"input", times}, {"output", translations}, {"interpolation", "CUBICSPLINE"}},
                               {{"input", backward}, {"output", translations}},
                               {{"input", times}, {"output", infinite}},
                               {{"input", translations}, {"output", translations}},
                               {{"input", times}, {"output", 99}},
                               {{"input", times}, {"output", translations}, {"interpolation", "QUADRATIC"}}}},
                             {"channels", {channel(0, 0, "translation")}}});
    ASSERT_EQ(load(good).scene.animations.size(), 1u);

    const std::vector<Json> bad = {channel(1, 0, "translation"),
                                   channel(2, 0, "translation"),
                                   channel(3, 0, "translation"),
                                   channel(4, 0, "translation"),
                                   channel(5, 0, "translation"),
                                   channel(6, 0, "translation"),
                                   channel(7, 0, "translation"),
                                   channel(-1, 0, "translation"),
                                   channel(0, 0, "rotation"),
                                   channel(0, 0, "weights"),
                                   channel(0, 1, "translation"),
                                   channel(0, 9, "translation"),
                                   Json::object(),
                                   {{"sampler", 0}, {"target", Json::object()}}};
    for (const Json& one : bad) {
        GltfBuilder builder = good;
        builder.json["animations"][0]["channels"].push_back(one);
        const LoadedScene loaded = load(builder);
        ASSERT_EQ(loaded.scene.animations.size(), 1u) << one;
        EXPECT_EQ(loaded.scene.animations[0].channels.size(), 1u) << one;
        ASSERT_EQ(loaded.notes.size(), 1u) << one;
        EXPECT_EQ(loaded.notes[0], "1 animation channel moves no node and is left out");
    }
}

// Nodes that no scene shows may be their own parents; nothing follows them round.
TEST(GltfAnimations, CyclesThatNothingShowsDoNoHarm) {
    GltfBuilder builder;
    builder.root({{"name", "shown"}});
    builder.push("nodes", {{"children", {2}}});
    builder.push("nodes", {{"children", {1}}});
    const int times = builder.floats("SCALAR", {0, 1}),
              translations = builder.floats("VEC3", {0, 0, 0, 1, 2, 3});
    builder.push("animations", {{"samplers", {{{"input", times}, {"output", translations}}}},
                                {"channels", {channel(0, 1, "translation")}}});
    const Scene scene = load(builder).scene;
    ASSERT_EQ(scene.animations.size(), 1u);
    EXPECT_EQ(worldFromRest(scene.nodes, scene.animations[0], 1).size(), 3u);
}

}  // namespace
}  // namespace phat
