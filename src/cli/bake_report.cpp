#include "cli/bake_report.h"

#include <fmt/format.h>

#include <filesystem>

#include "core/atlas/texel_size.h"
#include "io/base/printable.h"

namespace phat {
namespace {

using nlohmann::json;

// A stage that takes less of the whole is not worth a line.
constexpr double kMinFractionShown = 0.02;

// An atlas that is off its size by more than this is worth one.
constexpr double kMaxOffFraction = 0.1;

}  // namespace

std::optional<std::string> resolutionNote(const Bake& result, const AtlasSettings& asked) {
    if (asked.texelSizeMeters > 0) return {};
    const auto made = double(result.atlas.texelCount()), wanted = double(asked.texelBudget);
    if (std::abs(made - wanted) <= kMaxOffFraction * wanted) return {};
    const std::string reason =
        made > wanted
            ? fmt::format(
                  "its {} charts are whole tiles of {}x{} texels with a gutter around them, and larger "
                  "texels would not make these fewer",
                  result.stats.atlas.chartCount, kTileSize, kTileSize)
            : fmt::format(
                  "charts grow by whole tiles of {}x{} texels up to {} texels a side, and finer ones "
                  "would be more than that",
                  kTileSize, kTileSize, asked.maxSizeTexels);
    return fmt::format("the atlas has {} texels, coverage {:.1f} %, and not the {} that were asked for: {}",
                       result.atlas.texelCount(), 100 * double(result.stats.atlas.coverage),
                       asked.texelBudget, reason);
}

json reportOf(const std::string& output, const Bake& result, size_t resumedParts,
              const std::vector<StageTime>& stageTimes, const std::vector<std::string>& notes) {
    const BakeStats& stats = result.stats;
    json stages = json::array();
    for (const StageTime& stage : stageTimes)
        stages.push_back({{"name", stage.name}, {"seconds", stage.seconds}});
    return {{"output", output},
            {"bytes", std::filesystem::file_size(output)},
            {"atlas",
             {{"width", result.atlas.sizeTexels.x},
              {"height", result.atlas.sizeTexels.y},
              {"texelSize", result.atlas.texelSizeMeters},
              {"medianTexelSize", medianTexelSizeMeters(result.atlas)},
              {"finestTexelSize", result.atlas.finestTexelSizeMeters()},
              {"charts", stats.atlas.chartCount},
              {"coverage", stats.atlas.coverage},
              {"areaWithinStretch15", stats.atlas.areaWithinStretch15},
              {"degenerateTriangles", stats.atlas.degenerateTriangles}}},
            {"photons", {{"emitted", stats.photons.emitted}, {"stored", stats.photons.stored}}},
            {"phatexels", {{"layers", result.phatexture.indirect.size()}, {"valid", stats.validPhatexels}}},
            {"rays", stats.rays},
            {"resumedParts", resumedParts},
            {"seconds", stats.seconds},
            {"stages", stages},
            {"notes", notes}};
}

json dynamicReport(const Bake& result) {
    const Phatexture& light = result.phatexture;
    const auto isDark = [](const PackedPhatexel& texel) { return texel.radiance == 0; };
    const auto& area = light.area.front().texels;
    const bool darkArea = std::all_of(area.begin(), area.end(), isDark);
    const uint64_t areaBytes = sizeof(PackedPhatexel) + sizeof(uint32_t);  // a texel, with its irradiance
    const uint64_t indirectBytes = light.indirect.size() * sizeof(PackedPhatexel) + sizeof(uint32_t);
    const uint64_t dark = result.stats.darkTexels;
    const uint64_t bytes = dark * indirectBytes + (darkArea ? result.atlas.texelCount() : dark) * areaBytes;
    return {{"darkTexels", dark}, {"darkAreaLayer", darkArea}, {"bytes", bytes}};
}

json keptReport(const Bake& result, const EarlierFile& earlier) {
    const BakeStats& stats = result.stats;
    return {{"from", earlier.source.path},
            {"charts", stats.atlas.keptCharts},
            {"earlierCharts", earlier.baked.atlas.charts.size()},
            {"phatexels", stats.kept.phatexels},
            {"stages", stats.kept.stages}};
}

namespace {

void printKept(const json& kept, uint32_t charts) {
    std::string stages;
    for (const json& stage : kept["stages"]) stages += ", " + stage.get<std::string>();
    fmt::print("  kept        {} of {} charts ({} before), {} PHATexels{}\n", kept["charts"].get<uint32_t>(),
               charts, kept["earlierCharts"].get<size_t>(), kept["phatexels"].get<uint64_t>(), stages);
}

void printDynamic(const json& dynamic) {
    fmt::print("  dynamic     {} texels of dark sides{}, {:.1f} MB before compression\n",
               dynamic["darkTexels"].get<uint64_t>(),
               dynamic["darkAreaLayer"].get<bool>() ? ", a dark layer of area lights" : "",
               dynamic["bytes"].get<double>() * 1e-6);
}

}  // namespace

void printReport(const json& report, const std::vector<std::string>& printed) {
    const json& atlas = report["atlas"];
    fmt::print("{}: {:.1f} MB\n", report["output"].get<std::string>(), report["bytes"].get<double>() * 1e-6);
    const double coarsest = atlas["texelSize"].get<double>() * 1e3,
                 median = atlas["medianTexelSize"].get<double>() * 1e3,
                 finest = atlas["finestTexelSize"].get<double>() * 1e3;
    const std::string range =
        finest < coarsest ? fmt::format(" ({:.4g} to {:.4g} mm)", finest, coarsest) : "";
    fmt::print("  atlas       {} x {} texels of {:.4g} mm{}, {} charts, coverage {:.1f} %\n",
               atlas["width"].get<uint32_t>(), atlas["height"].get<uint32_t>(), median, range,
               atlas["charts"].get<uint32_t>(), atlas["coverage"].get<double>() * 100);
    if (report.contains("dynamic")) printDynamic(report["dynamic"]);
    if (report.contains("kept")) printKept(report["kept"], atlas["charts"].get<uint32_t>());
    fmt::print("  photons     {} emitted, {} stored\n", report["photons"]["emitted"].get<uint64_t>(),
               report["photons"]["stored"].get<uint64_t>());
    fmt::print("  PHATexels   {} valid, {} rays\n", report["phatexels"]["valid"].get<uint64_t>(),
               report["rays"].get<uint64_t>());
    if (const json& probes = report["probes"]; probes["count"] != 0)
        fmt::print("  probes      {}, {:.0f} kB, {} rays\n", probes["count"].get<size_t>(),
                   probes["bytes"].get<double>() * 1e-3, probes["rays"].get<uint64_t>());
    if (const auto parts = report["resumedParts"].get<size_t>())
        fmt::print("  resumed     {} parts\n", parts);
    const auto seconds = report["seconds"].get<double>();
    fmt::print("  time        {:.1f} s\n", seconds);
    for (const json& stage : report["stages"]) {
        const auto taken = stage["seconds"].get<double>();
        if (taken > kMinFractionShown * seconds)
            fmt::print("    {:<19} {:.1f} s\n", stage["name"].get<std::string>(), taken);
    }
    for (const json& note : report["notes"])
        if (std::find(printed.begin(), printed.end(), note.get<std::string>()) == printed.end())
            fmt::print("  note        {}\n", printable(note.get<std::string>()));
}

}  // namespace phat
