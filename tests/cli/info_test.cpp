#include <fmt/format.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/bake/bake.h"
#include "io/gltf/gltf_loader.h"
#include "io/image/image_file.h"
#include "io/phat/baked_file.h"
#include "support/run_program.h"
#include "support/temporary_folder.h"
#include "support/variant_scene.h"

namespace phat {
namespace {

const std::string kScene = PHAT_SOURCE_DIR "/scenes/cornell-glossy.glb";

// A coarse bake of a real scene: what is read back counts here, not how good it looks.
struct BakedFileCommands : testing::Test {
    static Bake coarseBake(const Scene& scene) {
        BakeSettings settings;
        settings.atlas.texelSizeMeters = 0.3f;
        settings.photons.count = 5000;
        settings.pathsPerPhatexel = 1;
        settings.irradianceSamples = 1;
        settings.layers = 2;
        SilentProgress progress;
        return bake(scene, settings, progress);
    }

    BakedFileCommands() {
        writeBakedFile(path, kScene, scene, baked, {"test", "cornell-glossy.glb", "{}", 7});
    }

    TemporaryFolder folder;
    std::string path = folder.file("room.phat.glb");
    Scene scene = loadGltf(kScene).scene;
    Bake baked = coarseBake(scene);
};

TEST(InfoCommand, DescribesAPlainScene) {
    const ProgramResult result = runPhat({"info", kScene, "--json"});
    ASSERT_EQ(result.exitCode, 0) << result.err;
    const auto report = nlohmann::json::parse(result.out);
    EXPECT_EQ(report["scene"]["triangles"], 46);
    EXPECT_EQ(report["scene"]["materials"].size(), 7u);
    EXPECT_EQ(report["scene"]["emissiveMaterials"], 1);
    EXPECT_EQ(report["scene"]["cameras"], nlohmann::json({"Camera"}));
    EXPECT_NEAR(report["scene"]["bounds"]["high"][1], 2.775, 1e-3);
    EXPECT_FALSE(report.contains("bake"));
    EXPECT_NE(runPhat({"info", kScene}).out.find("46 in "), std::string::npos);
}

TEST(InfoCommand, ListsVariantsOfWhichOneIsBaked) {
    const TemporaryFolder folder;
    const std::string text = sceneWithVariants(), path = folder.file("room.gltf");
    writeBytes(path, {text.begin(), text.end()});
    const auto report = nlohmann::json::parse(runPhat({"info", path, "--json"}).out);
    EXPECT_EQ(report["scene"]["variants"], nlohmann::json({"dark", "as it is"}));
    EXPECT_NE(runPhat({"info", path}).out.find("dark, as it is"), std::string::npos);

    // Upper-case extensions are the same.
    const std::string target = folder.file("ROOM.PHAT.GLB");
    const ProgramResult baked = runPhat({"bake", path, "-o", target, "--variant", "dark", "--resolution",
                                         "1k", "--photons", "1k", "--quiet"});
    ASSERT_EQ(baked.exitCode, 0) << baked.err;
    const auto bakedReport = nlohmann::json::parse(runPhat({"info", target, "--json"}).out);
    EXPECT_EQ(bakedReport["bake"]["record"]["settings"]["variant"], "dark");
    EXPECT_EQ(bakedReport["scene"]["variants"], nlohmann::json({"dark", "as it is"}));
    EXPECT_EQ(runPhat({"bake", target, "-o", folder.file("b.glb"), "--variant", "dark"}).exitCode, 2);

    const auto brightness = [&](const std::vector<std::string>& more) {
        std::vector<std::string> command = {
            "render",  path, "--method",          "path", "--spp", "4", "--size", "32x32",
            "--quiet", "-o", folder.file("a.exr")};
        command.insert(command.end(), more.begin(), more.end());
        const ProgramResult result = runPhat(command);
        EXPECT_EQ(result.exitCode, 0) << result.err;
        double sum = 0;
        for (const glm::vec3& pixel : readExr(folder.file("a.exr")).pixels) sum += pixel.x;
        return sum;
    };
    const double plain = brightness({}), dark = brightness({"--variant", "dark"});
    EXPECT_GT(plain, 0);
    EXPECT_NEAR(dark / plain, 0.1, 1e-3);
    const ProgramResult unknown = runPhat({"render", path, "--variant", "red", "-o", folder.file("a.JPEG")});
    EXPECT_EQ(unknown.exitCode, 1);
    EXPECT_NE(unknown.err.find("dark, as it is"), std::string::npos) << unknown.err;
    EXPECT_EQ(runPhat({"render", path, "--method", "path", "--spp", "1", "--size", "8x8", "--quiet", "-o",
                       folder.file("a.JPEG")})
                  .exitCode,
              0);
    EXPECT_EQ(readPicture(folder.file("a.JPEG")).width, 8);
}

TEST(InfoCommand, RefusesWhatIsNoScene) {
    const TemporaryFolder folder;
    writeBytes(folder.file("text.glb"), {'h', 'e', 'l', 'l', 'o'});
    for (const char* name : {"text.glb", "missing.glb"})
        for (const ProgramResult& result :
             {runPhat({"info", folder.file(name)}),
              runPhat({"export", folder.file(name), "--exr", folder.file("out")})}) {
            EXPECT_EQ(result.exitCode, 1);
            EXPECT_EQ(result.err.rfind("phat: " + folder.file(name) + ": ", 0), 0u) << result.err;
        }
}

TEST_F(BakedFileCommands, InfoCountsWhatWasBaked) {
    const ProgramResult result = runPhat({"info", path, "--json"});
    ASSERT_EQ(result.exitCode, 0) << result.err;
    const auto bake = nlohmann::json::parse(result.out)["bake"];
    const size_t texels = baked.atlas.texelCount();
    EXPECT_EQ(bake["atlas"]["size"][0], baked.atlas.sizeTexels.x);
    EXPECT_EQ(bake["atlas"]["charts"], baked.atlas.charts.size());
    EXPECT_EQ(bake["atlas"]["texelSizeMeters"], baked.atlas.texelSizeMeters);
    // The scene's sharpest metal, of roughness .2, takes all that the settings allow.
    EXPECT_EQ(bake["atlas"]["finestTexelSizeMeters"], baked.atlas.texelSizeMeters / 3);
    EXPECT_EQ(bake["indirect"]["layers"], 2);
    EXPECT_EQ(bake["indirect"]["phatexels"], 2 * texels);
    EXPECT_EQ(bake["indirect"]["bytes"], 2 * texels * 8);
    size_t valid = 0;
    for (const PhatexelLayer& layer : baked.phatexture.indirect)
        for (const PackedPhatexel& texel : layer.texels) valid += unpackPhatexel(texel, 1).valid;
    EXPECT_EQ(bake["indirect"]["valid"], valid);
    EXPECT_EQ(bake["record"]["seed"], 7);
    EXPECT_EQ(bake["record"]["source"], "cornell-glossy.glb");
    EXPECT_NE(runPhat({"info", path}).out.find("in 2 layers"), std::string::npos);
}

TEST_F(BakedFileCommands, ExportWritesThePhatexels) {
    const std::string out = folder.file("pictures/of the room");
    const ProgramResult result = runPhat({"export", path, "--exr", out});
    ASSERT_EQ(result.exitCode, 0) << result.err;
    const auto frames = blockFrames(baked.atlas, baked.points);
    for (int layer = 0; layer < 2; ++layer) {
        const std::string prefix = out + "/layer" + std::to_string(layer) + "-";
        const Image radiance = readExr(prefix + "radiance.exr"),
                    direction = readExr(prefix + "direction.exr"),
                    distance = readExr(prefix + "distance.exr"), validity = readExr(prefix + "validity.exr");
        ASSERT_EQ(radiance.width, int(baked.atlas.sizeTexels.x));
        ASSERT_EQ(radiance.height, int(baked.atlas.sizeTexels.y));
        size_t valid = 0;
        for (size_t i = 0; i < radiance.pixels.size(); ++i) {
            const Phatexel expected =
                unpackPhatexel(baked.phatexture.indirect[size_t(layer)].texels[i], baked.atlas.unitMeters);
            ASSERT_EQ(validity.pixels[i].x, expected.valid ? 1.0f : 0.0f);
            if (!expected.valid) {
                ASSERT_EQ(direction.pixels[i], glm::vec3(0));
                continue;
            }
            ++valid;
            ASSERT_EQ(radiance.pixels[i], expected.radiance);
            ASSERT_EQ(distance.pixels[i].x, expected.distance);
            const glm::uvec2 texel(i % baked.atlas.sizeTexels.x, i / baked.atlas.sizeTexels.x);
            const Frame& frame = frames[baked.atlas.blockAt(texel)];
            ASSERT_LT(glm::distance(frame.toLocal(direction.pixels[i]), expected.directionBlock), 1e-5f);
        }
        EXPECT_GT(valid, 100u);
    }
}

TEST_F(BakedFileCommands, ExportNeedsABakedFile) {
    const ProgramResult result = runPhat({"export", kScene, "--exr", folder.file("out")});
    EXPECT_EQ(result.exitCode, 1);
    EXPECT_NE(result.err.find("is not a baked file"), std::string::npos) << result.err;
    EXPECT_FALSE(std::filesystem::exists(folder.file("out")));
    EXPECT_EQ(runPhat({"export", path}).exitCode, 2);
}

// The share of texels under a surface, by the word coverage in both; part of the floor is under the boxes.
TEST(Coverage, IsTheSameByBakeAndByInfo) {
    const TemporaryFolder folder;
    const std::string out = folder.file("room.phat.glb");
    const std::vector<std::string> bake = {"bake",      kScene, "-o",        out, "--resolution", "60k",
                                           "--photons", "20k",  "--bounces", "2", "--paths",      "1"};
    std::vector<std::string> asJson = bake;
    asJson.push_back("--json");
    const auto baked = nlohmann::json::parse(runPhat(asJson).out)["atlas"];
    const auto read = nlohmann::json::parse(runPhat({"info", out, "--json"}).out)["bake"]["atlas"];
    EXPECT_EQ(read["coverage"].get<double>(), baked["coverage"].get<double>());
    EXPECT_GT(read["notOccluded"].get<double>(), 0.4);
    EXPECT_LT(read["notOccluded"].get<double>(), read["coverage"].get<double>() - 0.005);
    const std::string words =
        fmt::format(" charts, coverage {:.1f} %", 100 * baked["coverage"].get<double>());
    for (const std::string& text : {runPhat(bake).out, runPhat({"info", out}).out})
        EXPECT_NE(text.find(words), std::string::npos) << text;
}

}  // namespace
}  // namespace phat
