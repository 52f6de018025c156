#include <gtest/gtest.h>

#include <cmath>

#include "io/base/file_error.h"
#include "io/gltf/gltf_builder.h"
#include "io/gltf/gltf_loader.h"
#include "io/gltf/gltf_sound.h"
#include "support/temporary_folder.h"

namespace phat {
namespace {

using test::GltfBuilder;
using Json = nlohmann::json;

LoadedScene loadWithNotes(const GltfBuilder& builder) {
    const TemporaryFolder folder;
    writeBytes(folder.file("a.glb"), builder.glb());
    const LoadedScene loaded = loadGltf(folder.file("a.glb"));
    EXPECT_EQ(test::countUnsound(loaded.scene), 0);
    return loaded;
}

Scene load(const GltfBuilder& builder) {
    return loadWithNotes(builder).scene;
}

GltfBuilder withLight(const Json& light, Json node) {
    GltfBuilder builder;
    builder.json["extensions"]["KHR_lights_punctual"]["lights"] = Json::array({light});
    if (!node.contains("extensions")) node["extensions"]["KHR_lights_punctual"]["light"] = 0;
    builder.root(node);
    return builder;
}

TEST(GltfLights, SpotConesRangeAndDirection) {
    const double half = std::sqrt(0.5);
    const Scene scene = load(
        withLight({{"type", "spot"},
                   {"name", "lamp"},
                   {"color", {1, 0.5, 0.25}},
                   {"intensity", 40},
                   {"range", 12},
                   {"spot", {{"innerConeAngle", 0.2}, {"outerConeAngle", 0.6}}}},
                  {{"translation", {1, 2, 3}}, {"rotation", {-half, 0, 0, half}}, {"scale", {5, 5, 5}}}));
    ASSERT_EQ(scene.lights.size(), 1u);
    const PunctualLight& light = scene.lights[0];
    EXPECT_EQ(light.name, "lamp");
    EXPECT_EQ(light.type, PunctualLight::Type::spot);
    EXPECT_EQ(light.intensity, glm::vec3(40, 20, 10));  // the node's scale does not brighten it
    EXPECT_EQ(light.position, glm::vec3(1, 2, 3));
    EXPECT_NEAR(glm::distance(light.direction, glm::vec3(0, -1, 0)), 0, 1e-6f);
    EXPECT_FLOAT_EQ(light.cosInnerCone, std::cos(0.2f));
    EXPECT_FLOAT_EQ(light.cosOuterCone, std::cos(0.6f));
    EXPECT_EQ(light.rangeMeters, 12);
}

TEST(GltfLights, DefaultsOfEachType) {
    const PunctualLight point = load(withLight({{"type", "point"}}, {{"name", "bulb"}})).lights.at(0);
    EXPECT_EQ(point.name, "bulb");
    EXPECT_EQ(point.intensity, glm::vec3(1));
    EXPECT_EQ(point.rangeMeters, 0);
    const PunctualLight sun =
        load(withLight({{"type", "directional"}, {"intensity", 3}}, Json::object())).lights.at(0);
    EXPECT_EQ(sun.type, PunctualLight::Type::directional);
    EXPECT_EQ(sun.direction, glm::vec3(0, 0, -1));
    const PunctualLight spot =
        load(withLight({{"type", "spot"}, {"spot", Json::object()}}, Json::object())).lights.at(0);
    EXPECT_EQ(spot.cosInnerCone, 1);
    EXPECT_FLOAT_EQ(spot.cosOuterCone, std::sqrt(0.5f));
}

TEST(GltfLights, NonsenseIsLeftOutWithANote) {
    for (const Json& light :
         {Json{{"type", "laser"}}, Json::object(), Json{{"type", 3}},
          Json{{"type", "point"}, {"intensity", -1}}, Json{{"type", "point"}, {"color", {1, 1}}}}) {
        GltfBuilder builder = withLight({{"type", "point"}}, Json::object());
        builder.json["extensions"]["KHR_lights_punctual"]["lights"].push_back(light);
        builder.root({{"extensions", {{"KHR_lights_punctual", {{"light", 1}}}}}});
        const LoadedScene loaded = loadWithNotes(builder);
        EXPECT_EQ(loaded.scene.lights.size(), 1u) << light;
        ASSERT_EQ(loaded.notes.size(), 1u) << light;
        EXPECT_NE(loaded.notes[0].find("light 1 is left out: it"), std::string::npos) << loaded.notes[0];
    }
    EXPECT_THROW(
        load(withLight({{"type", "point"}}, {{"extensions", {{"KHR_lights_punctual", {{"light", 9}}}}}})),
        FileError);
}

TEST(GltfLights, ConesOutOfOrderAreMended) {
    const auto expectCone = [](const Json& spot, float inner, float outer, size_t notes) {
        Json light = {{"type", "spot"}};
        if (!spot.is_null()) light["spot"] = spot;
        const LoadedScene loaded = loadWithNotes(withLight(light, Json::object()));
        ASSERT_EQ(loaded.scene.lights.size(), 1u) << spot;
        EXPECT_NEAR(loaded.scene.lights[0].cosInnerCone, std::cos(inner), 1e-6f) << spot;
        EXPECT_NEAR(loaded.scene.lights[0].cosOuterCone, std::cos(outer), 1e-6f) << spot;
        EXPECT_EQ(loaded.notes.size(), notes) << spot;
    };
    constexpr float kRight = kPi / 2, kDefault = kPi / 4;
    expectCone({{"innerConeAngle", 1}, {"outerConeAngle", 0.5}}, 0.5f, 0.5f, 1);
    expectCone({{"innerConeAngle", 0.2}, {"outerConeAngle", 3}}, 0.2f, kRight, 1);
    expectCone({{"innerConeAngle", -1}, {"outerConeAngle", "wide"}}, 0, kDefault, 1);
    // As they are exported, but for the last digits.
    expectCone({{"innerConeAngle", 0.5}, {"outerConeAngle", 0.5}}, 0.5f, 0.5f, 0);
    expectCone({{"outerConeAngle", 1.5707964}}, 0, kRight, 0);
    // Left away as a whole, it is the default, too.
    expectCone(Json(), 0, kDefault, 0);
}

TEST(GltfLights, RangesWithoutEndAndWithoutSense) {
    const auto rangeOf = [](const Json& range, size_t notes) {
        const LoadedScene loaded =
            loadWithNotes(withLight({{"type", "point"}, {"range", range}}, Json::object()));
        EXPECT_EQ(loaded.notes.size(), notes) << range;
        return loaded.scene.lights.at(0).rangeMeters;
    };
    EXPECT_EQ(rangeOf(3.40282347e38, 0), 0);  // farther than any scene reaches: none
    EXPECT_EQ(rangeOf(1e300, 0), 0);
    EXPECT_EQ(rangeOf(1e6, 0), 1e6f);
    EXPECT_EQ(rangeOf(-2, 1), 0);
    EXPECT_EQ(rangeOf("far", 1), 0);
}

TEST(GltfCameras, PerspectiveAndOrthographicWithNames) {
    GltfBuilder builder;
    const int wide =
        builder.push("cameras", {{"type", "perspective"},
                                 {"name", "wide"},
                                 {"perspective", {{"yfov", 1.25}, {"znear", 0.5}, {"aspectRatio", 1.5}}}});
    const int plan =
        builder.push("cameras", {{"type", "orthographic"},
                                 {"orthographic", {{"xmag", 4}, {"ymag", 2}, {"znear", 0.1}, {"zfar", 9}}}});
    builder.root({{"camera", wide}, {"translation", {0, 1, 5}}, {"scale", {3, 3, 3}}});
    builder.root(
        {{"camera", plan}, {"name", "top"}, {"matrix", {-1, 0, 0, 0, 0, 0, -1, 0, 0, 1, 0, 0, 0, 7, 0, 1}}});
    const Scene scene = load(builder);
    ASSERT_EQ(scene.cameras.size(), 2u);

    const Camera& first = scene.cameras[0];
    EXPECT_EQ(first.name, "wide");
    EXPECT_TRUE(first.perspective);
    EXPECT_EQ(first.yfovRadians, 1.25f);
    EXPECT_EQ(first.aspect, 1.5f);
    EXPECT_EQ(first.znear, 0.5f);
    EXPECT_EQ(first.worldFromCamera[0], glm::vec4(1, 0, 0, 0));  // no scale
    EXPECT_EQ(first.worldFromCamera[3], glm::vec4(0, 1, 5, 1));

    const Camera& second = scene.cameras[1];
    EXPECT_EQ(second.name, "top");
    EXPECT_FALSE(second.perspective);
    EXPECT_EQ(second.ymag, 2);
    EXPECT_EQ(second.aspect, 2);
    EXPECT_EQ(second.worldFromCamera[2], glm::vec4(0, 1, 0, 0));  // looks down
    // The node mirrors; a picture is not.
    EXPECT_NEAR(glm::determinant(glm::mat3(second.worldFromCamera)), 1, 1e-6f);
}

TEST(GltfCameras, ImpossibleOnesAreLeftOutWithANote) {
    std::vector<Json> cameras = {
        {{"type", "perspective"}},
        {{"type", "fisheye"}},
        Json::object(),
        {{"type", "perspective"}, {"perspective", {{"yfov", "wide"}, {"znear", 0.1}}}},
        {{"type", "orthographic"}, {"orthographic", {{"xmag", 0}, {"ymag", 0}, {"znear", 0}, {"zfar", 1}}}}};
    for (const double yfov : {0.0, -1.0, 3.2, 1e300})
        cameras.push_back({{"type", "perspective"}, {"perspective", {{"yfov", yfov}, {"znear", 0.1}}}});
    for (const Json& camera : cameras) {
        GltfBuilder builder;
        builder.root({{"camera", builder.push("cameras", camera)}});
        builder.root({{"camera", builder.push("cameras", {{"type", "perspective"},
                                                          {"perspective", {{"yfov", 1}, {"znear", 0.1}}}})}});
        const LoadedScene loaded = loadWithNotes(builder);
        EXPECT_EQ(loaded.scene.cameras.size(), 1u) << camera;
        ASSERT_EQ(loaded.notes.size(), 1u) << camera;
        EXPECT_NE(loaded.notes[0].find("camera 0 is left out: it"), std::string::npos) << loaded.notes[0];
    }
}

}  // namespace
}  // namespace phat
