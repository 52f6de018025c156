// The estimate that --memory-limit is compared with, and the peak that a bake then has.
// PHAT_MEMORY_CASES=all tries ten scenes and settings, which takes minutes, and prints them.

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "support/run_limited.h"

namespace phat {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using Arguments = std::vector<std::string>;

struct MemoryCase {
    std::string name, scene;
    Arguments settings;
    bool always = false;
};

const std::string kScenes = PHAT_SOURCE_DIR "/scenes/";

void writeText(const std::string& path, const std::string& text) {
    std::ofstream(path, std::ios::binary) << text;
}

// The scene with all surfaces of albedo .99.
std::string whitened(const TemporaryFolder& folder, const std::string& name) {
    const std::vector<char> bytes = readBytes(kScenes + name);
    uint32_t length;
    std::memcpy(&length, &bytes[12], sizeof(length));
    json gltf = json::parse(bytes.begin() + 20, bytes.begin() + 20 + length);
    for (json& material : gltf["materials"])
        material["pbrMetallicRoughness"]["baseColorFactor"] = {.99, .99, .99, 1};
    std::string text = gltf.dump();
    text.resize((text.size() + 3) / 4 * 4, ' ');
    std::string out(bytes.begin(), bytes.begin() + 20);
    const auto textBytes = uint32_t(text.size()), total = uint32_t(bytes.size() - length + text.size());
    std::memcpy(&out[12], &textBytes, sizeof(textBytes));
    std::memcpy(&out[8], &total, sizeof(total));
    out += text + std::string(bytes.begin() + 20 + length, bytes.end());
    writeText(folder.file(name), out);
    return folder.file(name);
}

// As many pixels as may be, in runs: a grey sky.
std::string largestSky(const TemporaryFolder& folder) {
    constexpr int kWidth = 16384, kHeight = 8192, kRun = 127;
    std::string row = {2, 2, char(kWidth / 256), char(kWidth % 256)};
    for (const char value : {'\x5a', '\x64', '\x78', '\x80'})
        for (int left = kWidth; left > 0; left -= kRun) row += {char(128 + std::min(left, kRun)), value};
    std::string sky = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 8192 +X 16384\n";
    for (int y = 0; y < kHeight; ++y) sky += row;
    writeText(folder.file("sky.hdr"), sky);
    return folder.file("sky.hdr");
}

std::vector<MemoryCase> cases(const TemporaryFolder& folder) {
    const fs::path shared = fs::path(PHAT_SOURCE_DIR) / ".." / "shared";
    return {
        {"smallest", PHAT_SOURCE_DIR "/fuzz/corpus/gltf/room.glb", {"--resolution", "4k"}, true},
        {"tabletop --samples 8", kScenes + "tabletop.glb", {"--resolution", "128k", "--samples", "8"}, true},
        {"furnace, albedo .99, 1000 bounces",
         whitened(folder, "furnace.glb"),
         {"--resolution", "64k", "--bounces", "1000", "--photons", "50k"},
         true},
        {"cornell, albedo .99, 2M photons",
         whitened(folder, "cornell-glossy.glb"),
         {"--resolution", "64k", "--bounces", "1000", "--photons", "2M"}},
        {"tabletop, sky of 2^27 pixels",
         kScenes + "tabletop.glb",
         {"--resolution", "64k", "--environment", largestSky(folder)}},
        {"gallery --radiance path", kScenes + "gallery.glb", {"--radiance", "path", "--paths", "1"}},
        {"gallery --storage paper", kScenes + "gallery.glb", {"--resolution", "256k", "--storage", "paper"}},
        {"white-room", shared / "hostile/white-room.glb", {}},
        {"garage", shared / "rooms/garage/garage.gltf", {"--texel-size", "0.02"}},
        {"home-theater", shared / "rooms/home-theater/home-theater.gltf", {"--resolution", "512k"}},
        {"nvpro-cornell", shared / "rooms/nvpro-cornell/cornellBox.gltf", {"--resolution", "2M"}},
    };
}

TEST(ConductMemory, TheEstimateIsABoundAndAtMostTwiceThePeak) {
    if (kSanitizerFactor > 1) GTEST_SKIP() << "sanitizers take memory of their own";
    const bool all = std::getenv("PHAT_MEMORY_CASES") != nullptr;
    const TemporaryFolder folder;
    for (const MemoryCase& one : cases(folder)) {
        if ((!all && !one.always) || !fs::exists(one.scene)) continue;
        Arguments arguments{"bake", one.scene, "-o", folder.file("out.phat.glb"), "--json", "--quiet"};
        arguments.insert(arguments.end(), one.settings.begin(), one.settings.end());
        const auto result = runPhat(arguments);
        ASSERT_EQ(result.exitCode, 0) << one.name << result.err;
        const json report = json::parse(result.out);
        const double estimate = report["memory"]["estimatedBytes"], peak = report["memory"]["peakBytes"];
        if (all) std::printf("| %s | %.0f | %.0f |\n", one.name.c_str(), estimate * 1e-6, peak * 1e-6);
        EXPECT_LE(peak, estimate) << one.name;
        EXPECT_LE(estimate, 2 * peak) << one.name;
    }
}

}  // namespace
}  // namespace phat
