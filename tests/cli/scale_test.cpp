// Files in another unit than the metre.

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/render/metrics.h"
#include "io/image/image_file.h"
#include "support/gltf_writer.h"
#include "support/run_program.h"
#include "support/scaled_scene.h"

namespace phat {
namespace {

using namespace test;

// A wall on a floor, without light and camera: the program adds both.
std::string writeYard(const TemporaryFolder& folder, float factor, float floorSize = 4) {
    Scene scene;
    Material wall = lambert(0.7f);
    wall.doubleSided = true;
    addFloor(scene, lambert(0.5f), floorSize);
    addQuad(scene, wall, {-1.5f, 0, 0}, {3, 0, 0}, {0, 1, 0});
    const std::string path = folder.file("yard.gltf");
    writeGltf(path, scaledScene(scene, factor));
    return path;
}

std::string noteOn(const std::vector<std::string>& command, const std::string& ofNotes) {
    const ProgramResult result = runPhat(command);
    EXPECT_EQ(result.exitCode, 0) << result.err;
    const auto report = nlohmann::json::parse(result.out);
    for (const auto& note : report.at(nlohmann::json::json_pointer(ofNotes)))
        if (note.get<std::string>().find("glTF's unit is the metre") != std::string::npos) return note;
    return "";
}

TEST(ScaleOfFiles, UnlikelySizesGetANote) {
    const TemporaryFolder folder;
    const std::string target = folder.file("yard.phat.glb");
    for (const float factor : {1.0f, 200.0f, 0.02f, 1000.0f, 0.001f}) {
        SCOPED_TRACE(factor);
        const std::string yard = writeYard(folder, factor);
        const std::string expected =
            factor == 1000     ? "4 km across, and glTF's unit is the metre: exported in millimetres?"
            : factor == 0.001f ? "4 mm across, and glTF's unit is the metre: exported in another unit?"
                               : "";
        const auto expectNote = [&](const std::string& note) {
            EXPECT_EQ(note, expected.empty() ? "" : "the scene is " + expected);
        };
        expectNote(noteOn({"info", yard, "--json"}, "/scene/notes"));
        expectNote(noteOn({"bake", yard, "-o", target, "--resolution", "1k", "--photons", "1k", "--json"},
                          "/notes"));
        expectNote(noteOn({"info", target, "--json"}, "/scene/notes"));
    }
    // Map coordinates.
    Scene house;
    addQuad(house, lambert(0.5f), {4e5f, 0, -5e6f}, {8, 0, 0}, {0, 4, 0});
    writeGltf(folder.file("house.gltf"), house);
    const auto notes = nlohmann::json::parse(runPhat({"info", folder.file("house.gltf"), "--json"}).out)
                           .at("scene")
                           .at("notes");
    EXPECT_EQ(notes.front(),
              "the scene is 5000 km from its origin, where positions are exact to 596 mm: "
              "move it there");
    // A wall on a large ground is no scene in another unit.
    EXPECT_EQ(noteOn({"info", writeYard(folder, 1, 5000), "--json"}, "/scene/notes"), "");
}

// From the file to the picture: texels of a given size, the light and the view that the program adds.
TEST(ScaleOfFiles, PicturesAreTheSameInEveryUnit) {
    const TemporaryFolder folder;
    const auto picture = [&](float factor) {
        const std::string yard = writeYard(folder, factor), target = folder.file("yard.phat.glb"),
                          image = folder.file("yard.exr");
        ProgramResult result = runPhat({"bake", yard, "-o", target, "--texel-size",
                                        std::to_string(0.1f * factor), "--photons", "20k", "--quiet"});
        EXPECT_EQ(result.exitCode, 0) << result.err;
        result =
            runPhat({"render", target, "-o", image, "--size", "72x48", "--reflections", "lookup", "--quiet"});
        EXPECT_EQ(result.exitCode, 0) << result.err;
        return readExr(image);
    };
    const Image inMeters = picture(1);
    for (const float factor : {1000.0f, 0.001f, 20'000.0f}) {
        const Metrics error = compareImages(picture(factor), inMeters);
        EXPECT_LT(std::abs(error.bias), kSameMean) << factor;
        EXPECT_LT(error.maeOverMean, 0.02) << factor;
    }
}

}  // namespace
}  // namespace phat
