#include "io/gltf/gltf_light_profiles.h"

#include <gtest/gtest.h>

#include "core/scene/light_punctual.h"
#include "io/base/file_error.h"
#include "io/gltf/gltf_built.h"
#include "support/ies_writer.h"

namespace phat::test {
namespace {

using Json = nlohmann::json;

// A lobe along a horizontal angle of 60 degrees alone.
std::string lobeText() {
    IesWriter file;
    file.vertical = degreesFrom(0, 180, 5);
    file.horizontal = degreesFrom(0, 360, 15);
    file.candela = [](double v, double h) {
        return 20 +
               380 * std::max(0.0, std::sin(double(kPi) / 180 * v) * std::cos(double(kPi) / 180 * (h - 60)));
    };
    return file.text();
}

std::vector<char> lobeBytes() {
    const std::string text = lobeText();
    return {text.begin(), text.end()};
}

GltfBuilder withProfile(Json node, Json extension = {{"light", 0}}) {
    GltfBuilder builder;
    const int view = builder.view(lobeBytes());
    builder.json["extensions"]["EXT_lights_ies"]["lights"] = {
        {{"name", "lobe"}, {"bufferView", view}, {"mimeType", "application/x-ies-lm-63"}}};
    node["extensions"]["EXT_lights_ies"] = std::move(extension);
    builder.root(node);
    return builder;
}

TEST(GltfLightProfiles, PointAlongTheirNode) {
    const double half = std::sqrt(0.5);
    // A quarter turn about x: -z points down, +x stays.
    const LoadedScene loaded = load(withProfile({{"name", "lamp"},
                                                 {"translation", {1, 2, 3}},
                                                 {"rotation", {-half, 0, 0, half}},
                                                 {"scale", {3, 3, 3}}},
                                                {{"light", 0}, {"multiplier", 2}, {"color", {1, 0.5, 4}}}));
    EXPECT_TRUE(loaded.notes.empty());
    const PunctualLight& light = loaded.scene.lights.at(0);
    EXPECT_EQ(light.name, "lamp");
    EXPECT_EQ(light.type, PunctualLight::Type::point);
    EXPECT_NEAR(light.intensity.x, 800, 1e-2);
    EXPECT_NEAR(light.intensity.y, 400, 1e-2);
    EXPECT_NEAR(light.intensity.z, 800, 1e-2);  // colours are clamped
    EXPECT_EQ(light.position, glm::vec3(1, 2, 3));
    // y is turned to -z.
    EXPECT_NEAR(photometricFalloff(light, {0.5f, 0, -0.8660254f}), 1, 1e-5f);
    EXPECT_NEAR(photometricFalloff(light, {1, 0, 0}), 0.525f, 1e-5f);
    EXPECT_NEAR(photometricFalloff(light, {0.5f, 0, 0.8660254f}), 0.05f, 1e-5f);
    EXPECT_NEAR(photometricFalloff(light, {0, -1, 0}), 0.05f, 1e-5f);
    EXPECT_EQ(light.photometry->web().name, "lobe");
}

TEST(GltfLightProfiles, StandBesideThePunctualLightOfTheirNode) {
    GltfBuilder builder = withProfile({{"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
    builder.json["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}}};
    EXPECT_EQ(load(builder).scene.lights.size(), 2u);
}

TEST(GltfLightProfiles, BrokenOnesAreLeftOutWithANote) {
    GltfBuilder builder = withProfile(Json::object());
    builder.json["extensions"]["EXT_lights_ies"]["lights"] = {
        {{"uri", "data:application/octet-stream;base64,AAAA"}}};
    const LoadedScene loaded = load(builder);
    EXPECT_TRUE(loaded.scene.lights.empty());
    ASSERT_EQ(loaded.notes.size(), 1u);
    EXPECT_NE(loaded.notes[0].find("light profile 0 \"light profile 0\" cannot be used"), std::string::npos)
        << loaded.notes[0];
    EXPECT_NE(loaded.notes[0].find("control character 0x00"), std::string::npos) << loaded.notes[0];
    EXPECT_THROW(load(withProfile(Json::object(), {{"light", 4}})), FileError);
    EXPECT_THROW(load(withProfile(Json::object(), {{"light", 0}, {"multiplier", -1}})), FileError);
    EXPECT_THROW(load(withProfile(Json::object(), {{"light", 0}, {"color", {1, 1}}})), FileError);
}

// The light of a name gets the photometry, keeps its colour and becomes what the changed file says.
TEST(GltfLightProfiles, AreAttachedByName) {
    GltfBuilder builder;
    builder.json["extensionsUsed"] = {"KHR_lights_punctual"};
    builder.json["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "spot"},
                                                                    {"color", {0.5, 1, 0.25}},
                                                                    {"intensity", 9},
                                                                    {"range", 2},
                                                                    {"spot", Json::object()}}};
    builder.root({{"name", "a lamp"}, {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
    builder.root({{"name", "other"}, {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
    const TemporaryFolder folder;
    writeBytes(folder.file("a.glb"), builder.glb());
    const std::string text = lobeText();
    const NamedPhotometry named{"a lamp", "lobe.ies", {text.begin(), text.end()}, 3};
    GltfSource source = openGltf(folder.file("a.glb"));
    const Scene scene = loadGltf(source, {.variant = {}, .photometries = {named}}).scene;
    const PunctualLight& light = scene.lights.at(0);
    EXPECT_EQ(light.type, PunctualLight::Type::point);
    EXPECT_EQ(light.rangeMeters, 0);
    EXPECT_NEAR(luminance(light.intensity), 3 * 400, 0.05);
    EXPECT_NEAR(light.intensity.x / light.intensity.y, 0.5, 1e-6);
    EXPECT_EQ(scene.lights.at(1).type, PunctualLight::Type::spot);
    EXPECT_FALSE(scene.lights.at(1).photometry);

    const std::string json = source.json.dump();
    writeBytes(folder.file("b.gltf"), {json.begin(), json.end()});
    const Scene again = loadGltf(folder.file("b.gltf")).scene;
    ASSERT_EQ(again.lights.size(), 2u);
    EXPECT_EQ(again.lights[0].intensity, light.intensity);
    EXPECT_EQ(again.lights[0].direction, light.direction);
    EXPECT_EQ(again.lights[0].horizontalZero, light.horizontalZero);
    EXPECT_EQ(again.lights[0].photometry->web().relative, light.photometry->web().relative);

    GltfSource other = openGltf(folder.file("a.glb"));
    try {
        loadGltf(other, {.variant = {}, .photometries = {{"lamp", "lobe.ies", named.bytes, 1}}});
        FAIL();
    } catch (const FileError& error) {
        EXPECT_EQ(error.reason,
                  "has no point or spot light \"lamp\" for the photometry of lobe.ies; there are "
                  "\"a lamp\", \"other\"");
    }
}

}  // namespace
}  // namespace phat::test
