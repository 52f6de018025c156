// phat bake --ies and what phat info says of it.

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "support/gltf_writer.h"
#include "support/ies_writer.h"
#include "support/run_program.h"
#include "support/scene_builder.h"

namespace phat::test {
namespace {

using nlohmann::json;

struct CliIes : testing::Test {
    CliIes() {
        Scene floor;
        addFloor(floor, lambert(0.5f), 2);
        writeGltf(scene, floor);
        json gltf = json::parse(readBytes(scene));
        gltf["extensionsUsed"] = {"KHR_lights_punctual"};
        gltf["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "spot"}, {"spot", json::object()}}};
        // Down, from two metres above.
        gltf["nodes"].push_back({{"name", "lamp"},
                                 {"translation", {0, 2, 0}},
                                 {"rotation", {-std::sqrt(0.5), 0, 0, std::sqrt(0.5)}},
                                 {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
        gltf["scenes"][0]["nodes"].push_back(1);
        const std::string text = gltf.dump();
        writeBytes(scene, {text.begin(), text.end()});
        IesWriter file;
        file.vertical = degreesFrom(0, 90, 1);
        file.horizontal = {0};
        file.candela = [](double v, double) { return 300 * std::max(0.0, std::cos(double(kPi) / 180 * v)); };
        const std::string ies = file.text();
        writeBytes(lamp, {ies.begin(), ies.end()});
    }
    ProgramResult bake(const std::string& photometry) const {
        return runPhat({"bake", scene, "-o", baked, "--ies", photometry, "--resolution", "2k", "--photons",
                        "1k", "--quiet"});
    }
    TemporaryFolder folder;
    const std::string scene = folder.file("floor.gltf"), lamp = folder.file("lambert:1.ies"),
                      baked = folder.file("floor.phat.glb");
};

TEST_F(CliIes, TheBakeHasTheLampsLumensAndAngles) {
    ASSERT_EQ(bake("lamp=" + lamp + ":2").exitCode, 0);
    const ProgramResult info = runPhat({"info", baked, "--json"});
    ASSERT_EQ(info.exitCode, 0) << info.err;
    const json light = json::parse(info.out)["scene"]["lights"].at(0);
    EXPECT_EQ(light["type"], "point");
    const json photometry = light["photometry"];
    EXPECT_EQ(photometry["name"], "lambert:1.ies");
    EXPECT_NEAR(photometry["lumens"].get<double>(), 600 * double(kPi), 1);
    EXPECT_NEAR(photometry["peakCandela"].get<double>(), 600, 0.01);
    EXPECT_NEAR(photometry["beamDegrees"][0].get<double>(), 120, 0.3);
    EXPECT_NEAR(photometry["fieldDegrees"][1].get<double>(), 2 * 84.26, 0.3);
    const ProgramResult text = runPhat({"info", baked});
    EXPECT_NE(text.out.find("lamp: lambert:1.ies, 1885 lm, peak 600 cd, beam 120 and field 168 degrees"),
              std::string::npos)
        << text.out;
}

TEST_F(CliIes, SaysWhatIsWrong) {
    const auto expectError = [&](const std::string& photometry, int code, const std::string& text) {
        const ProgramResult result = bake(photometry);
        EXPECT_EQ(result.exitCode, code) << photometry;
        EXPECT_NE(result.err.find(text), std::string::npos) << result.err;
    };
    expectError("bulb=" + lamp, 1,
                "has no point or spot light \"bulb\" for the photometry of " + lamp + "; there are \"lamp\"");
    expectError("lamp", 2, "\"lamp\" is not LIGHT=FILE");
    expectError("lamp=" + lamp + ":-3", 2, "\"-3\" is not a multiplier");
    expectError("lamp=" + folder.file("none.ies"), 1, "none.ies: no such file");
    writeBytes(folder.file("bad.ies"), {'T', 'I', 'L', 'T', '=', 'N', 'O', 'N', 'E', '\n', '1'});
    expectError("lamp=" + folder.file("bad.ies"), 1, "bad.ies: ends before its lumens per lamp");
    ASSERT_EQ(bake("lamp=" + lamp).exitCode, 0);
    const ProgramResult again =
        runPhat({"bake", baked, "-o", folder.file("again.phat.glb"), "--ies", "lamp=" + lamp, "--quiet"});
    EXPECT_EQ(again.exitCode, 1);
    EXPECT_NE(again.err.find("is baked with the photometry that it has"), std::string::npos) << again.err;
}

}  // namespace
}  // namespace phat::test
