// Files of others: without a light, without a camera, as bright as they happen to be.

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <utility>

#include "io/image/image_file.h"
#include "support/gltf_writer.h"
#include "support/run_program.h"
#include "support/scene_builder.h"

namespace phat {
namespace {

using namespace test;
using nlohmann::json;

// A box on a floor, without light.
std::string writeYard(const TemporaryFolder& folder) {
    Scene scene;
    addFloor(scene, lambert(0.5f), 4);
    addQuad(scene, lambert(0.7f), {-0.5f, 0, 0}, {1, 0, 0}, {0, 1, 0});
    scene.materials.back().doubleSided = true;
    writeGltf(folder.file("yard.gltf"), scene);
    return folder.file("yard.gltf");
}

std::string writeRoom(const TemporaryFolder& folder) {
    Scene scene;
    addRoom(scene, lambert(0.6f), {4, 2.5f, 3});
    writeGltf(folder.file("room.gltf"), scene);
    return folder.file("room.gltf");
}

struct Drawn {
    ProgramResult result;
    json report;
    Image picture;
    double mean = 0;
};

// By the path tracer unless `flags` say otherwise.
Drawn draw(const TemporaryFolder& folder, const std::string& file, const std::string& picture,
           std::vector<std::string> flags = {"--method", "path"}, const std::string& spp = "16") {
    std::vector<std::string> words = {"render", file, "-o",    folder.file(picture), "--size", "72x48",
                                      "--spp",  spp,  "--json"};
    words.insert(words.end(), flags.begin(), flags.end());
    Drawn drawn{runPhat(words), {}, {}};
    EXPECT_EQ(drawn.result.exitCode, 0) << drawn.result.err;
    drawn.report = json::parse(drawn.result.out, nullptr, false);
    drawn.picture = readPicture(folder.file(picture));
    for (const glm::vec3& pixel : drawn.picture.pixels)
        drawn.mean += double(luminance(pixel)) / double(drawn.picture.pixels.size());
    return drawn;
}

size_t countOf(const std::string& text, const std::string& part) {
    size_t count = 0;
    for (size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
    return count;
}

TEST(Lit, AFileWithoutLightGetsDaylightAndSaysSo) {
    const TemporaryFolder folder;
    const std::string yard = writeYard(folder);
    const Drawn drawn = draw(folder, yard, "a.png");
    EXPECT_EQ(countOf(drawn.result.err, yard + ": no light in the file: lit by a clear sky, the sun at"), 1u)
        << drawn.result.err;
    EXPECT_EQ(drawn.report["notes"].size(), 1u);
    EXPECT_EQ(drawn.report["exposure"]["auto"], true);
    EXPECT_LT(drawn.report["exposure"]["stops"].get<double>(), -4);  // daylight
    EXPECT_GT(drawn.mean, 0.08);
    EXPECT_LT(drawn.mean, 0.5);

    // By hand: a floor in sun and sky is brighter than without the sun's share, and its light is that of the
    // flags.
    const Drawn high = draw(folder, yard, "high.exr", {"--method", "path", "--sky", "sun=0,80"});
    const Drawn low = draw(folder, yard, "low.exr", {"--method", "path", "--sky", "sun=0,10"});
    EXPECT_GT(high.mean, 2 * low.mean);
    EXPECT_FALSE(high.report.contains("exposure"));
    EXPECT_FALSE(high.report.contains("notes"));

    const Drawn none = draw(folder, yard, "none.png", {"--method", "path", "--sky", "none"});
    EXPECT_NE(none.result.err.find("nothing emits light"), std::string::npos) << none.result.err;
    EXPECT_EQ(none.mean, 0);
    EXPECT_TRUE(draw(folder, yard, "quiet.png", {"--method", "path", "--quiet"}).result.err.empty());
}

// Baked, the sky and the sun are in the file, and its picture is that of path tracing.
TEST(Lit, ABakeHoldsItsDaylight) {
    const TemporaryFolder folder;
    const std::string yard = writeYard(folder), again = folder.file("again.phat.glb");
    std::string baked = folder.file("yard.phat.glb");
    const auto bake = [&](const std::string& in, std::vector<std::string> more) {
        std::vector<std::string> words = {"bake", in,       "-o",        baked, "--resolution",
                                          "32k",  "--json", "--photons", "20k"};
        words.insert(words.end(), more.begin(), more.end());
        const auto result = runPhat(words);
        EXPECT_EQ(result.exitCode, 0) << result.err;
        return json::parse(result.out, nullptr, false);
    };
    EXPECT_EQ(bake(yard, {})["notes"].size(), 1u);
    const auto infoOf = [&] { return json::parse(runPhat({"info", baked, "--json"}).out, nullptr, false); };
    const json info = infoOf();
    ASSERT_EQ(info["scene"]["lights"].size(), 1u);
    EXPECT_EQ(info["scene"]["lights"][0]["type"], "directional");
    EXPECT_NEAR(info["scene"]["lights"][0].value("angularDiameterDegrees", 0.0), 0.533, 1e-3);
    EXPECT_FALSE(info["scene"]["environment"].is_null());
    EXPECT_EQ(info["bake"]["record"]["settings"]["sky"], "sun=210,40,turbidity=3");
    EXPECT_EQ(info["scene"]["defaultCamera"]["where"], "outside");

    const Drawn expected = draw(folder, yard, "path.exr", {"--method", "path"}, "64");
    const Drawn traced = draw(folder, baked, "traced.exr", {"--method", "path"}, "64");
    EXPECT_NEAR(traced.mean, expected.mean, 0.01 * expected.mean);  // the same view and light
    const Drawn drawn = draw(folder, baked, "baked.exr", {});
    double error = 0;
    for (size_t i = 0; i < drawn.picture.pixels.size(); ++i)
        error += std::abs(double(luminance(drawn.picture.pixels[i] - expected.picture.pixels[i]))) /
                 double(drawn.picture.pixels.size());
    EXPECT_LT(error,
              0.06 * expected.mean);  // the shadow's edge, in pixels of 5 cm, and the path tracer's noise
    EXPECT_NEAR(drawn.mean, expected.mean, 0.03 * expected.mean);

    // What is asked for replaces what an earlier bake added.
    const std::string first = std::exchange(baked, again);
    bake(first, {"--sky", "sun=90,20"});
    EXPECT_EQ(infoOf()["scene"]["lights"].size(), 1u);
    EXPECT_EQ(infoOf()["bake"]["record"]["settings"]["sky"], "sun=90,20,turbidity=3");
    const Drawn other = draw(folder, yard, "other.exr", {"--method", "path", "--sky", "sun=90,20"}, "64");
    EXPECT_NEAR(draw(folder, baked, "again.exr", {"--method", "path"}, "64").mean, other.mean,
                0.01 * other.mean);
    EXPECT_EQ(runPhat({"render", baked, "-o", folder.file("no.png"), "--sky", "sun=0,30"}).exitCode, 2);
}

// The yard with a light of an exporter.
std::string writeLamp(const TemporaryFolder& folder, const json& generator, const char* type,
                      double intensity) {
    const std::string path = writeYard(folder);
    const auto bytes = readBytes(path);
    json gltf = json::parse(bytes.begin(), bytes.end());
    if (!generator.is_null()) gltf["asset"]["generator"] = generator;
    gltf["extensionsUsed"] = {"KHR_lights_punctual"};
    gltf["extensions"]["KHR_lights_punctual"]["lights"] = json::array(
        {{{"type", type}, {"name", "Lamp"}, {"color", {0.5, 1, 0.25}}, {"intensity", intensity}}});
    if (std::string(type) == "spot")
        gltf["extensions"]["KHR_lights_punctual"]["lights"][0]["spot"] = json::object();
    gltf["nodes"].push_back({{"translation", {0, 2, 0}},
                             {"rotation", {-0.7071068, 0, 0, 0.7071068}},
                             {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
    gltf["scenes"][0]["nodes"].push_back(1);
    const std::string text = gltf.dump();
    writeBytes(path, {text.begin(), text.end()});
    return path;
}

TEST(Lit, LightsInBlendersStandardUnitsAreNamed) {
    const json blender = "Khronos glTF Blender I/O v4.2.60";
    const struct {
        json generator;
        const char* type;
        double intensity;
        std::string unit;  // empty: nothing is said
    } cases[] = {{blender, "point", 54351.4, "54351 candela"},
                 {blender, "spot", 543.5, "544 candela"},
                 {blender, "directional", 683, "683 lux"},
                 {blender, "point", 79.6, ""},
                 {blender, "point", 190, ""},
                 {blender, "directional", 95, ""},
                 {json(), "point", 54351.4, ""},
                 {json(7), "point", 54351.4, ""},
                 {"another program", "directional", 683, ""}};
    for (const auto& c : cases) {
        const TemporaryFolder folder;
        const std::string file = writeLamp(folder, c.generator, c.type, c.intensity);
        const Drawn drawn = draw(folder, file, "a.png", {"--method", "path"}, "1");
        const std::string line =
            c.unit.empty() ? "Blender"
                           : file + ": light \"Lamp\" has " + c.unit + ": Blender's lighting mode Standard";
        EXPECT_EQ(countOf(drawn.result.err, line), c.unit.empty() ? 0u : 1u) << drawn.result.err;
        EXPECT_EQ(countOf(runPhat({"info", file, "--json"}).out, "Unitless"), c.unit.empty() ? 0u : 1u);
        EXPECT_EQ(countOf(drawn.result.err, "Unitless"), c.unit.empty() ? 0u : 1u);
    }
    // Said of the scene and not of its bake again, whose sun is as bright.
    const TemporaryFolder folder;
    const std::string yard = writeYard(folder), baked = folder.file("b.phat.glb");
    const auto bytes = readBytes(yard);
    json gltf = json::parse(bytes.begin(), bytes.end());
    gltf["asset"]["generator"] = blender;
    const std::string text = gltf.dump();
    writeBytes(yard, {text.begin(), text.end()});
    for (const std::string& input : {yard, baked}) {
        const ProgramResult result =
            runPhat({"bake", input, "-o", input == yard ? baked : folder.file("c.phat.glb"), "--resolution",
                     "8k", "--photons", "2k"});
        EXPECT_EQ(result.exitCode, 0) << result.err;
        EXPECT_EQ(countOf(result.err + result.out, "Blender"), 0u) << result.err;
    }
    const std::string lamp = writeLamp(folder, blender, "point", 54351.4);
    const ProgramResult result =
        runPhat({"bake", lamp, "-o", folder.file("d.phat.glb"), "--resolution", "8k", "--photons", "2k"});
    EXPECT_EQ(countOf(result.err, "Unitless"), 1u) << result.err;
    EXPECT_EQ(countOf(result.out, "Unitless"), 0u) << "said before the bake, not again after it";
}

TEST(Lit, AClosedRoomGetsAWorkLight) {
    const TemporaryFolder folder;
    const std::string room = writeRoom(folder);
    const Drawn drawn = draw(folder, room, "a.png");
    EXPECT_EQ(countOf(drawn.result.err, "no daylight reaches the inside: lit by a work light at ("), 1u)
        << drawn.result.err;
    EXPECT_GT(drawn.mean, 0.08);
    EXPECT_LT(drawn.mean, 0.6);
    const json info = json::parse(runPhat({"info", room, "--json"}).out, nullptr, false);
    EXPECT_EQ(info["scene"]["defaultCamera"]["where"], "inside");
    EXPECT_EQ(info["scene"]["lights"].size(), 0u);

    const Drawn sky = draw(folder, room, "b.png", {"--method", "path", "--sky", "sun=90,30"});
    EXPECT_NE(sky.result.err.find("nothing reaches the inside: add a light"), std::string::npos);
    EXPECT_EQ(sky.mean, 0);
}

TEST(Lit, SkiesAreChecked) {
    const TemporaryFolder folder;
    const std::string yard = writeYard(folder);
    const auto with = [&](const std::string& sky) {
        return runPhat({"render", yard, "-o", folder.file("a.exr"), "--method", "path", "--size", "8x8",
                        "--spp", "1", "--sky", sky});
    };
    for (const char* wrong :
         {"", "bright", "sun=10", "sun=10,100", "sun=10,-5", "sun=10,20,turbidity=1", "sun=a,20", "moon=1,2",
          "sun=1,20,sun=2,20", "time=2026-06-21T12:00", "time=2026-13-21T12:00,latitude=0,longitude=0",
          "time=noon,latitude=0,longitude=0", "time=2026-06-21T12:00,latitude=95,longitude=0",
          "time=2026-06-21T00:00,latitude=0,longitude=0",  // night
          "sun=1,20,time=2026-06-21T12:00,latitude=0,longitude=0"}) {
        const auto result = with(wrong);
        EXPECT_EQ(result.exitCode, 2) << wrong;
        EXPECT_EQ(countOf(result.err, "\n"), 1u) << result.err;
    }
    for (const char* right : {"auto", "none", "sun=10,20", "turbidity=6", "sun=-90,20,turbidity=2.5",
                              "time=2026-06-21T12:00,latitude=52.5,longitude=13.4",
                              "time=2026-06-21T14:00+02:00,latitude=52.5,longitude=13.4",
                              "time=2026-06-21T12:00:30Z,latitude=52.5,longitude=13.4,turbidity=4"})
        EXPECT_EQ(with(right).exitCode, 0) << right;
    const std::string mean = "a.exr";
    const auto meanOf = [&](const std::string& sky) {
        return draw(folder, yard, mean, {"--method", "path", "--sky", sky}).mean;
    };
    EXPECT_EQ(meanOf("time=2026-06-21T12:00,latitude=52.5,longitude=13.4"),
              meanOf("time=2026-06-21T14:00+02:00,latitude=52.5,longitude=13.4"));
}

TEST(Lit, EnvironmentsAreTurnedAndScaled) {
    const TemporaryFolder folder;
    Scene scene;  // a wall that faces +Z
    addQuad(scene, lambert(0.5f), {-1, -1, 0}, {2, 0, 0}, {0, 2, 0});
    writeGltf(folder.file("wall.gltf"), scene);
    Image sky(64, 32);
    for (int y = 8; y < 24; ++y)
        for (int x = 44; x < 52; ++x) sky.at(x, y) = glm::vec3(1);  // around azimuth pi / 2, +Z
    writeExr(folder.file("sky.exr"), sky);
    const auto meanWith = [&](std::vector<std::string> more) {
        std::vector<std::string> words = {"--method", "path",  "--environment", folder.file("sky.exr"),
                                          "--eye",    "0,0,2", "--target",      "0,0,0",
                                          "--fov",    "35"};
        words.insert(words.end(), more.begin(), more.end());
        return draw(folder, folder.file("wall.gltf"), "a.exr", words).mean;
    };
    const double front = meanWith({});
    EXPECT_GT(front, 0.01);
    EXPECT_NEAR(meanWith({"--environment-intensity", "3"}), 3 * front, 1e-4 * front);
    EXPECT_EQ(meanWith({"--environment-rotation", "360"}), front);
    EXPECT_EQ(meanWith({"--environment-rotation", "180"}), 0);
    EXPECT_LT(meanWith({"--environment-rotation", "60"}), 0.8 * front);
    EXPECT_EQ(runPhat({"render", folder.file("wall.gltf"), "-o", folder.file("b.png"),
                       "--environment-rotation", "5"})
                  .exitCode,
              2);
    EXPECT_EQ(runPhat({"render", folder.file("wall.gltf"), "-o", folder.file("b.png"), "--environment",
                       folder.file("sky.exr"), "--sky", "auto"})
                  .exitCode,
              2);

    // An infinite pixel is a sun.
    sky.at(48, 16) = glm::vec3(INFINITY);
    writeExr(folder.file("sky.exr"), sky);
    EXPECT_GT(meanWith({}), 50 * front);
}

TEST(Lit, ExposureIsPrintedAndIsForDisplaysOnly) {
    const TemporaryFolder folder;
    const std::string room = writeRoom(folder);
    const Drawn automatic = draw(folder, room, "a.png");
    const std::string stops = automatic.report["exposure"]["stops"].dump();
    draw(folder, room, "b.png", {"--method", "path", "--exposure", stops});
    EXPECT_EQ(readBytes(folder.file("a.png")), readBytes(folder.file("b.png")));
    draw(folder, room, "c.png", {"--method", "path", "--exposure", "-9"});
    EXPECT_NE(readBytes(folder.file("a.png")), readBytes(folder.file("c.png")));
    draw(folder, room, "a.exr");
    draw(folder, room, "b.exr", {"--method", "path", "--exposure", "3"});
    EXPECT_EQ(readBytes(folder.file("a.exr")), readBytes(folder.file("b.exr")));
    for (const char* wrong : {"much", "41", "nan", ""})
        EXPECT_EQ(runPhat({"render", room, "-o", folder.file("d.png"), "--exposure", wrong}).exitCode, 2)
            << wrong;
    const auto printed = runPhat(
        {"render", room, "-o", folder.file("a.png"), "--method", "path", "--size", "72x48", "--spp", "16"});
    EXPECT_NE(printed.out.find("exposure " + std::string(stops[0] == '-' ? "" : "+") + stops),
              std::string::npos)
        << printed.out;
    EXPECT_NE(printed.out.find("EV (auto)"), std::string::npos) << printed.out;
}

// Nothing that shines, and a camera that sees nothing: each picture is black, and says why.
TEST(Lit, BlackPicturesSayWhy) {
    const TemporaryFolder folder;
    const std::string room = writeRoom(folder);
    const auto causeOf = [&](const std::string& eye, const std::string& target, const std::string& sky) {
        const Drawn drawn = draw(
            folder, room, "a.png",
            {"--method", "path", "--exposure", "1", "--eye", eye, "--target", target, "--sky", sky}, "1");
        return drawn.report["exposure"].value("black", "");
    };
    EXPECT_NE(causeOf("1,1,1", "3,1,1", "none").find("no light reaches"), std::string::npos);
    EXPECT_NE(causeOf("1,1,9", "1,1,20", "none").find("no surface"), std::string::npos);
    EXPECT_EQ(causeOf("1,1,1", "3,1,1", "auto"), "");
    const auto printed = runPhat({"render", room, "-o", folder.file("b.png"), "--method", "path", "--size",
                                  "16x9", "--spp", "1", "--sky", "none"});
    EXPECT_NE(printed.out.find("the picture is black: no light"), std::string::npos) << printed.out;
}

// None of these may cost a bake, which would say so on stderr.
TEST(Lit, WrongNamesAreRefusedBeforeTheBake) {
    const TemporaryFolder folder;
    for (const auto& wrong : std::vector<std::vector<std::string>>{{"--camera", "nobody"},
                                                                   {"--set", "nobody.roughness=1"},
                                                                   {"--set", "*.roughness=2"},
                                                                   {"--eye", "1,1,1", "--target", "1,1,1"},
                                                                   {"--sky", "sun=1"},
                                                                   {"--animate", "0:1"},
                                                                   {"--exposure", "bright"}}) {
        std::vector<std::string> words = {"render", PHAT_SOURCE_DIR "/scenes/cornell-glossy.glb", "-o",
                                          folder.file("a.png")};
        words.insert(words.end(), wrong.begin(), wrong.end());
        const auto result = runPhat(words);
        EXPECT_EQ(result.exitCode, 2) << wrong[0] << result.err;
        EXPECT_EQ(result.err.find("photons:"), std::string::npos) << result.err;
        EXPECT_EQ(countOf(result.err, "\n"), 1u) << result.err;
    }
    EXPECT_EQ(folder.fileCount(), 0u);
}

// Nothing shines in the file, so that without the flag there is no layer that a lamp could be switched on in.
TEST(Dynamic, KeepsALayerForLampsThatAreOff) {
    const TemporaryFolder folder;
    const std::string room = writeRoom(folder), baked = folder.file("room.phat.glb");
    for (const bool dynamic : {false, true}) {
        std::vector<std::string> words = {"bake",         room, "-o",        baked, "--sky",    "none",
                                          "--resolution", "2k", "--photons", "1k",  "--probes", "none"};
        if (dynamic) words.push_back("--dynamic");
        const ProgramResult result = runPhat(words);
        ASSERT_EQ(result.exitCode, 0) << result.err;
        EXPECT_EQ(result.out.find("a dark layer of area lights") != std::string::npos, dynamic) << result.out;
        const json bake = json::parse(runPhat({"info", baked, "--json"}).out)["bake"];
        EXPECT_EQ(bake["dynamic"], dynamic);
        EXPECT_EQ(bake["area"]["layers"], dynamic ? 1 : 0);
        EXPECT_EQ(runPhat({"info", baked}).out.find("it can light up") != std::string::npos, dynamic);
    }
}

}  // namespace
}  // namespace phat
