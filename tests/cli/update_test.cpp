// phat bake --update and --atlas-of through the whole program.

#include <gtest/gtest.h>

#include <functional>
#include <map>
#include <nlohmann/json.hpp>

#include "io/gltf/glb_builder.h"
#include "io/gltf/gltf_source.h"
#include "io/image/image_file.h"
#include "io/phat/baked_file.h"
#include "support/run_program.h"

namespace phat {
namespace {

using nlohmann::json;

// A room with an area light, and things that stand in it.
const std::string kRoom = PHAT_SOURCE_DIR "/scenes/tabletop.glb";

json& named(json& gltf, const char* array, const std::string& name) {
    for (json& item : gltf[array])
        if (item.value("name", "") == name) return item;
    throw std::runtime_error("the scene has no " + name);
}

void shift(json& gltf, const std::string& node, double x) {
    json& translation = named(gltf, "nodes", node)["translation"];
    translation[0] = translation[0].get<double>() + x;
}

void dropNode(json& gltf, const std::string& name) {
    const json& nodes = gltf["nodes"];
    json& roots = gltf["scenes"][0]["nodes"];
    for (size_t i = 0; i < roots.size(); ++i)
        if (nodes[roots[i].get<size_t>()].value("name", "") == name) return roots.erase(i), void();
}

void addNode(json& gltf, const json& node) {
    gltf["scenes"][0]["nodes"].push_back(gltf["nodes"].size());
    gltf["nodes"].push_back(node);
}

void addBulb(json& gltf) {
    const json bulb = {{"type", "point"}, {"color", {1.0, 0.7, 0.4}}, {"intensity", 45}};
    gltf["extensionsUsed"].push_back("KHR_lights_punctual");
    gltf["extensions"]["KHR_lights_punctual"]["lights"] = {bulb};
    addNode(gltf, {{"name", "bulb"},
                   {"translation", {-0.8, 1.6, 0.6}},
                   {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
}

void addCone(json& gltf) {
    json copy = named(gltf, "nodes", "cone");
    copy["name"] = "another";
    copy["translation"] = {0.8, 1.5, 1.0};
    addNode(gltf, copy);
}

// What changes between two bakes, and stages whose results stay.
struct Edit {
    const char* name;
    std::function<void(json& gltf)> apply;
    std::vector<std::string> kept;
};

const Edit kEdits[] = {
    {"camera",
     [](json& gltf) {
         named(gltf, "nodes", "Camera")["translation"] = {0.5, 1.5, 1.5};
     },
     {"all light"}},
    {"bulb",
     [](json& gltf) {
         gltf["extensions"]["KHR_lights_punctual"]["lights"][0]["color"] = {0.3, 0.5, 1.0};
     },
     {"find occluded texels", "soft shadows", "distances"}},
    {"area lamp",
     [](json& gltf) {
         named(gltf, "materials", "lamp")["emissiveFactor"] = {1.0, 0.9, 0.7};
     },
     {"find occluded texels", "distances"}},
    {"paint",
     [](json& gltf) {
         named(gltf, "materials", "wall_red")["pbrMetallicRoughness"]["baseColorFactor"] = {.3, .2, .1, 1};
     },
     {"find occluded texels", "area light", "soft shadows", "distances"}},
    {"moved", [](json& gltf) { shift(gltf, "crate", 0.05); }, {}},
    {"removed", [](json& gltf) { dropNode(gltf, "cone"); }, {}},
    {"added", addCone, {}},
};

struct Update : testing::Test {
    TemporaryFolder folder;
    const std::string scene = edited("room", [](json&) {});

    std::string edited(const std::string& name, const std::function<void(json& gltf)>& apply) {
        GltfSource source = openGltf(kRoom);
        readGltfBuffers(source);
        addBulb(source.json);
        apply(source.json);
        source.json.erase("buffers");
        const std::vector<uint8_t> bytes = glbBytes({source.json, source.buffers.at(0)});
        const std::string path = folder.file(name + ".glb");
        writeBytes(path, {bytes.begin(), bytes.end()});
        return path;
    }

    std::vector<std::string> arguments(const std::string& in, const std::string& out,
                                       const std::vector<std::string>& more) {
        std::vector<std::string> all = {"bake",      in,    "-o",      out, "--resolution", "30k",
                                        "--photons", "20k", "--paths", "1", "--probes",     "16"};
        all.insert(all.end(), more.begin(), more.end());
        return all;
    }

    json bake(const std::string& in, const std::string& out, std::vector<std::string> more = {}) {
        more.insert(more.end(), {"--json"});
        const auto result = runPhat(arguments(in, out, more));
        EXPECT_EQ(result.exitCode, 0) << result.err;
        return result.exitCode == 0 ? json::parse(result.out) : json();
    }
};

using Place = std::tuple<uint32_t, uint32_t, uint32_t, uint32_t, float>;

// The places of a file's charts, by the name of the node.
std::map<std::string, std::vector<Place>> placesIn(const std::string& file) {
    const BakedScene baked = readBakedFile(file);
    std::map<std::string, std::vector<Place>> places;
    for (const Chart& chart : baked.atlas.charts)
        places[baked.loaded.scene.surfaces[chart.surface].name].emplace_back(
            chart.originTile.x, chart.originTile.y, chart.sizeTiles.x, chart.sizeTiles.y,
            chart.texelSizeMeters);
    return places;
}

// Nodes of `now` whose charts are not all where they were.
std::vector<std::string> nodesElsewhere(const std::string& now, const std::string& before) {
    const auto was = placesIn(before);
    std::vector<std::string> elsewhere;
    for (const auto& [name, places] : placesIn(now))
        if (const auto found = was.find(name); found == was.end() || found->second != places)
            elsewhere.push_back(name);
    return elsewhere;
}

TEST_F(Update, OfTheSameSceneHasTheSameBytes) {
    const std::string old = folder.file("old.phat.glb"), out = folder.file("out.phat.glb");
    bake(scene, old);
    bake(scene, out, {"--atlas-of", old});
    EXPECT_EQ(readBytes(out), readBytes(old));
    const json report = bake(scene, out, {"--update", old});
    EXPECT_EQ(readBytes(out), readBytes(old));
    EXPECT_EQ(report["kept"]["stages"], json::array({"all light"}));
    EXPECT_EQ(report["kept"]["charts"], report["atlas"]["charts"]);
    EXPECT_EQ(report["rays"], 0);
    EXPECT_EQ(report["probes"]["rays"], 0);
}

TEST_F(Update, HasTheBytesOfABakeOnTheSameAtlas) {
    const std::string old = folder.file("old.phat.glb");
    bake(scene, old);
    for (const Edit& edit : kEdits) {
        const std::string now = edited(edit.name, edit.apply);
        const std::string updated = folder.file("updated.phat.glb"), anew = folder.file("anew.phat.glb");
        const json report = bake(now, updated, {"--update", old});
        const json without = bake(now, anew, {"--atlas-of", old});
        EXPECT_EQ(readBytes(updated), readBytes(anew)) << edit.name;
        EXPECT_NE(readBytes(updated), readBytes(old)) << edit.name;
        EXPECT_EQ(report["kept"]["stages"], json(edit.kept)) << edit.name;
        EXPECT_EQ(without["kept"]["stages"], json::array()) << edit.name;
        if (!edit.kept.empty()) {
            // Soft shadows are what takes rays of those stages.
            const bool fewer = edit.kept[0] == "all light" || edit.kept.size() > 2;
            EXPECT_EQ(report["rays"] < without["rays"], fewer) << edit.name;
            EXPECT_EQ(nodesElsewhere(updated, old), std::vector<std::string>()) << edit.name;
        }
    }
}

TEST_F(Update, WhatIsNewLeavesTheOthersWhereTheyAre) {
    const std::string old = folder.file("old.phat.glb"), out = folder.file("out.phat.glb");
    const std::string added = edited("added", addCone);
    bake(scene, old);
    bake(added, out, {"--update", old});
    EXPECT_EQ(nodesElsewhere(out, old), std::vector<std::string>{"another"});
    // It finds its tiles again when it is gone and comes back.
    const std::string without = folder.file("without.phat.glb"), again = folder.file("again.phat.glb");
    bake(scene, without, {"--update", out});
    const json report = bake(added, again, {"--update", without});
    EXPECT_EQ(report["kept"]["charts"].get<int>(), report["kept"]["earlierCharts"].get<int>());
    EXPECT_LE(nodesElsewhere(again, out).size(), 1u);
    EXPECT_LE(report["atlas"]["height"], readBakedFile(out).atlas.sizeTexels.y);
}

// The cone stands on the table top and divides it. The many small pieces of other things, which fill a tile
// each, do not say how fine the table top's texels are then.
TEST_F(Update, WhatIsUnwrappedAnewHasTexelsOfTheSizeThatItHad) {
    const std::string old = folder.file("old.phat.glb"), out = folder.file("out.phat.glb");
    bake(scene, old);
    bake(edited("removed", [](json& gltf) { dropNode(gltf, "cone"); }), out, {"--update", old});
    const auto sizeIn = [](const std::string& file) {
        const auto places = placesIn(file);
        float size = 0;
        for (const Place& place : places.at("table_top")) size = std::max(size, std::get<4>(place));
        return size;
    };
    EXPECT_NEAR(sizeIn(out) / sizeIn(old), 1, 0.15);
}

// No farther from a fresh bake than such bakes of other random numbers are from each other.
TEST_F(Update, LooksLikeAFreshBake) {
    const std::string old = folder.file("old.phat.glb");
    const std::string moved = edited("moved", [](json& gltf) { shift(gltf, "crate", -0.3); });
    bake(scene, old);
    const auto drawn = [&](const std::string& name, const std::vector<std::string>& more) {
        const std::string file = folder.file(name + ".phat.glb"), picture = folder.file(name + ".exr");
        bake(moved, file, more);
        const auto result = runPhat({"render", file, "-o", picture, "--size", "96x54", "--quiet"});
        EXPECT_EQ(result.exitCode, 0) << result.err;
        return readExr(picture);
    };
    const auto difference = [](const Image& a, const Image& b) {
        double sum = 0, light = 0;
        for (size_t i = 0; i < a.pixels.size(); ++i) {
            sum += glm::length(a.pixels[i] - b.pixels[i]);
            light += glm::length(b.pixels[i]);
        }
        return sum / light;
    };
    const Image
        updated = drawn("updated", {"--update", old}),
        fresh = drawn("fresh", {}), other = drawn("other", {"--seed", "2"}),
        before = readExr([&] {
            const std::string picture = folder.file("before.exr");
            EXPECT_EQ(runPhat({"render", old, "-o", picture, "--size", "96x54", "--quiet"}).exitCode, 0);
            return picture;
        }());
    // A quarter more: with other charts, borders lie elsewhere, too.
    EXPECT_LT(difference(updated, fresh), 1.25 * difference(other, fresh));
    EXPECT_GT(difference(before, fresh), difference(updated, fresh));
}

TEST_F(Update, GoesOnWhereItWasStopped) {
    const std::string old = folder.file("old.phat.glb"), whole = folder.file("whole.phat.glb"),
                      out = folder.file("out.phat.glb");
    bake(scene, old);
    const std::string now = edited("bulb", kEdits[1].apply);
    bake(now, whole, {"--update", old});
    // The disk is full when the journal has 300 kB.
    std::string command = "ulimit -f 300; trap '' XFSZ; exec " PHAT_PROGRAM;
    for (const std::string& argument : arguments(now, out, {"--update", old, "--quiet"}))
        command += " '" + argument + "'";
    EXPECT_EQ(runProgram("bash", {"-c", command}).exitCode, 1);
    ASSERT_TRUE(std::filesystem::exists(out + ".journal"));
    const json report = bake(now, out, {"--update", old, "--resume"});
    EXPECT_GT(report["resumedParts"], 0);
    EXPECT_EQ(report["kept"]["stages"], json(kEdits[1].kept));
    EXPECT_EQ(readBytes(out), readBytes(whole));
}

TEST_F(Update, RefusesWhatItCannotContinue) {
    const std::string old = folder.file("room.phat.glb"), out = folder.file("out.phat.glb");
    bake(scene, old);
    const auto refusal = [&](const std::string& of, const std::vector<std::string>& more) {
        std::vector<std::string> all = {"bake", scene, "--photons", "2k", "--paths", "1", "--quiet"};
        all.insert(all.end(), {"--update", of});
        all.insert(all.end(), more.begin(), more.end());
        const auto result = runPhat(all);
        return std::to_string(result.exitCode) + " " + result.err;
    };
    EXPECT_EQ(refusal(scene, {"-o", out}), "1 phat: " + scene + ": is not a baked file\n");
    EXPECT_EQ(refusal(old, {"-o", out, "--resolution", "20k"}),
              "1 phat: " + old +
                  ": was baked with --resolution 30000, not with --resolution 20000: give the "
                  "same, or bake anew\n");
    EXPECT_EQ(refusal(old, {"-o", out, "--resolution", "30k", "--gutter", "2"}),
              "1 phat: " + old +
                  ": was baked with --gutter 4, not with --gutter 2: give the same, or bake "
                  "anew\n");
    EXPECT_EQ(refusal(folder.file("none.glb"), {"-o", out}).substr(0, 2), "1 ");
    EXPECT_EQ(refusal(old, {"-o", out, "--max-megabytes", "1"}).substr(0, 2), "2 ");
    EXPECT_FALSE(std::filesystem::exists(out));
    // The output's own name is that of the earlier bake.
    const auto before = readBytes(old);
    const std::string said = refusal(old, {"--resolution", "30k"});
    EXPECT_EQ(said.substr(0, 2), "2 ") << said;
    EXPECT_EQ(readBytes(old), before);
    EXPECT_EQ(refusal(old, {"--resolution", "30k", "-o", old}), "0 ");
    EXPECT_NE(readBytes(old), before);  // it has fewer photons
}

}  // namespace
}  // namespace phat
