// Broken and unusual files through the whole program: bake, then draw what was baked.

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <set>
#include <sstream>
#include <thread>

#include "io/image/image_file.h"
#include "support/run_limited.h"

namespace phat {
namespace {

namespace fs = std::filesystem;

void expectFinite(const std::string& path) {
    const Image image = readExr(path);
    ASSERT_FALSE(image.pixels.empty());
    for (const glm::vec3& pixel : image.pixels) ASSERT_TRUE(std::isfinite(pixel.x + pixel.y + pixel.z));
}

// Bakes and draws `input`; returns what became of the bake.
ProgramResult bakeAndRender(const fs::path& input) {
    SCOPED_TRACE(input.filename().string());
    const TemporaryFolder folder;
    const std::string baked = folder.file("baked.glb"), picture = folder.file("picture.exr");
    const auto bake = runLimited({"bake", input, "-o", baked, "--resolution", "2k", "--photons", "2k",
                                  "--paths", "1", "--bounces", "4", "--probes", "64", "--quiet"});
    if (bake.exitCode != 0) {
        EXPECT_EQ(bake.exitCode, 1) << bake.err;
        const std::string start = "phat: " + input.string() + ": ";
        EXPECT_EQ(bake.err.rfind(start, 0), 0u) << bake.err;
        EXPECT_GT(bake.err.size(), start.size() + 5) << bake.err;
        EXPECT_EQ(std::count(bake.err.begin(), bake.err.end(), '\n'), 1) << bake.err;
        EXPECT_EQ(folder.fileCount(), 0u);
        return bake;
    }
    EXPECT_EQ(bake.err, "");
    EXPECT_EQ(folder.fileCount(), 1u);
    const auto render =
        runLimited({"render", baked, "-o", picture, "--size", "48x32", "--spp", "1", "--quiet"});
    EXPECT_EQ(render.exitCode, 0) << render.err;
    EXPECT_EQ(render.err, "");
    if (render.exitCode == 0) expectFinite(picture);
    return bake;
}

// Two at a time, since such small bakes keep one core busy.
template <class Item, class Work>
void forEachOf(const std::vector<Item>& items, const Work& work) {
    std::atomic<size_t> next = 0;
    const auto run = [&] {
        for (size_t i = next++; i < items.size(); i = next++) work(items[i]);
    };
    const std::jthread beside(run);
    run();
}

struct BrokenFile {
    std::string name, what, expected;
};

TEST(ConductFiles, BrokenFilesKeepToTheManifest) {
    const fs::path folder = collection("broken");
    std::ifstream manifest(folder / "MANIFEST.tsv");
    std::string line;
    std::getline(manifest, line);  // titles
    std::vector<BrokenFile> files;
    while (std::getline(manifest, line)) {
        std::istringstream columns(line);
        BrokenFile& file = files.emplace_back();
        for (std::string* column : {&file.name, &file.what, &file.expected})
            std::getline(columns, *column, '\t');
        // A camera that cannot be is left out; the manifest is older than that.
        if (file.name == "85-camera-zero-fov.glb") file.expected = "tolerate";
    }
    EXPECT_GT(files.size(), 40u);
    forEachOf(files, [&](const BrokenFile& file) {
        const int exitCode = bakeAndRender(folder / file.name).exitCode;
        EXPECT_FALSE(file.expected == "reject" && exitCode != 1) << file.name << ": " << file.what;
        EXPECT_FALSE(file.expected == "tolerate" && exitCode != 0) << file.name << ": " << file.what;
    });
}

TEST(ConductFiles, UnusualFilesAreBakedUnlessTheyHaveNoTriangles) {
    const std::set<std::string> empty = {"Mesh_PrimitiveMode_00.glb", "Mesh_PrimitiveMode_02.glb"};
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(collection("loader")))
        if (entry.path().extension() == ".glb") files.push_back(entry.path());
    EXPECT_GT(files.size(), 15u);
    forEachOf(files, [&](const fs::path& path) {
        const bool isEmpty = empty.contains(path.filename());
        const auto bake = bakeAndRender(path);
        EXPECT_EQ(bake.exitCode, isEmpty ? 1 : 0) << path;
        if (!isEmpty) return;
        EXPECT_NE(bake.err.find("no triangles"), std::string::npos) << bake.err;
        EXPECT_EQ(runPhat({"info", path}).exitCode, 0) << path;
    });
}

}  // namespace
}  // namespace phat
