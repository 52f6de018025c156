// phat bake: scene in, baked file out.

#include <fmt/format.h>
#include <tbb/global_control.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>

#include "cli/bake_report.h"
#include "cli/bake_stages.h"
#include "cli/commands.h"
#include "cli/count_option.h"
#include "cli/interrupt.h"
#include "cli/progress_bar.h"
#include "core/atlas/glossy_density.h"
#include "core/scene/lights.h"
#include "io/base/atomic_file.h"
#include "io/base/file_error.h"
#include "io/gltf/gltf_source.h"
#include "io/phat/bake_journal.h"
#include "io/phat/bake_record.h"
#include "io/phat/baked_file.h"

namespace phat {
namespace {

using nlohmann::json;

constexpr uint64_t kFewestTexels = 64;

struct BakeOptions {
    std::string input;
    std::string output;
    std::string environment;  // empty: none
    BakeSettings settings;
    std::optional<int> threads;
    double memoryLimitBytes = 0;
    std::optional<uint64_t> mostBytes;  // of the file
    bool resume = false;
    bool quiet = false;
    bool json = false;
};

// Texels of a size that was asked for are of that size, unless the densities were asked for as well.
float glossyDensityOf(const CLI::Option& option, bool texelSizeGiven) {
    if (!option) return texelSizeGiven ? 1.0f : AtlasSettings().glossyDensity;
    const auto density = option.as<float>();
    if (!(density >= 1 && density <= kMostGlossyDensity))  // CLI::Range lets nan pass
        throw CLI::ValidationError(
            option.get_name(), fmt::format("{} is not a density from 1 to {}", density, kMostGlossyDensity));
    return density;
}

std::string defaultOutput(const std::string& input) {
    std::filesystem::path path(input);
    path.replace_extension();
    if (path.extension() == ".phat") path.replace_extension();
    return path.string() + ".phat.glb";
}

double physicalMemoryBytes() {
    return double(sysconf(_SC_PHYS_PAGES)) * double(sysconf(_SC_PAGE_SIZE));
}

LoadedScene loadInput(const BakeOptions& options, GltfSource& source) {
    LoadedScene loaded;
    if (isBakedFile(source))
        loaded = readBakedFile(source).loaded;  // with the environment that it was baked in
    else
        loaded = loadGltf(source);
    if (!options.environment.empty()) loaded.scene.environment = loadEnvironment(options.environment);
    if (loaded.scene.triangles.empty()) throw FileError(options.input, "has no triangles to bake");
    return loaded;
}

void refuseTooLarge(const BakeOptions& options, const Scene& scene) {
    const auto needed = double(estimateBakeMemory(scene, options.settings));
    if (needed > options.memoryLimitBytes)
        throw FileError(
            options.input,
            fmt::format("the bake would need about {:.2f} GB of memory, the limit is {:.2f} GB: a "
                        "larger --texel-size, a smaller --resolution or fewer --photons need less",
                        needed * 1e-9, options.memoryLimitBytes * 1e-9));
}

uint64_t fingerprintOf(const BakeOptions& options, const GltfSource& source, const BakeRecord& record) {
    Fingerprint fingerprint;
    fingerprint.add(record.generator);
    fingerprint.add(record.settings);
    addGltf(fingerprint, source);
    if (!options.environment.empty()) addFile(fingerprint, options.environment);
    return fingerprint.value();
}

void checkOutput(const BakeOptions& options) {
    if (std::filesystem::path(options.output).extension() != ".glb")
        throw CLI::ValidationError("--output", fmt::format("\"{}\" does not end in .glb", options.output));
    std::error_code ignored;
    for (const std::string& input : {options.input, options.environment})
        if (std::filesystem::equivalent(input, options.output, ignored))
            throw CLI::ValidationError("--output", fmt::format("would overwrite the input {}", input));
    checkReplaceable(options.output);
}

// The same failure, always with a file's name; `kept` tells what remains of the work.
[[noreturn]] void failWith(const std::exception& error, const std::string& input, const std::string& kept) {
    if (dynamic_cast<const Interrupted*>(&error)) throw Interrupted("interrupted" + kept);
    if (const auto* large = dynamic_cast<const FileTooLarge*>(&error)) throw *large;
    if (const auto* failed = dynamic_cast<const FileError*>(&error))
        throw FileError(failed->path, failed->reason + kept);
    const bool memory = dynamic_cast<const std::bad_alloc*>(&error);
    throw FileError(input, (memory ? "out of memory" : error.what()) + kept);
}

void bakeOnce(const BakeOptions& options, const GltfSource& source, const LoadedScene& loaded) {
    const BakeRecord record = recordOf(options.settings, options.input, options.environment);
    const std::string journalPath = options.output + ".journal";
    FileJournal journal(journalPath, fingerprintOf(options, source, record), options.resume);
    json report;
    try {
        ProgressBar progress(progressStyle(options.quiet), bakeStages(options.settings));
        const Bake result = bake(loaded.scene, options.settings, progress, &journal);
        std::vector<std::string> notes = loaded.notes;
        for (std::string& note : writeBakedFile(options.output, source, loaded.scene, result, record,
                                                {&progress, options.mostBytes.value_or(~uint64_t(0))}))
            notes.push_back(std::move(note));
        report = reportOf(options.output, result, journal.resumedRecords(), progress.stageTimes(), notes);
    } catch (const std::exception& error) {
        if (journal.empty() || dynamic_cast<const FileTooLarge*>(&error)) journal.remove();
        failWith(error, options.input,
                 journal.empty()
                     ? ""
                     : fmt::format("; the same command with --resume goes on from {}", journalPath));
    }
    journal.remove();
    if (options.json)
        fmt::print("{}\n", report.dump(-1, ' ', false, json::error_handler_t::replace));
    else if (!options.quiet)
        printReport(report);
}

void runBake(BakeOptions options) {
    std::optional<tbb::global_control> threads;
    if (options.threads)
        threads.emplace(tbb::global_control::max_allowed_parallelism, size_t(*options.threads));
    catchInterrupts();

    GltfSource source = openGltf(options.input);  // kept: the baked file is rewritten from it
    const LoadedScene loaded = loadInput(options, source);
    checkOutput(options);
    uint64_t& texels = options.settings.atlas.texelBudget;
    if (options.mostBytes)
        texels =
            std::min(texels, texelsThatFit(*options.mostBytes, std::filesystem::file_size(options.input),
                                           options.settings.layers, LightSampler(loaded.scene).hasArea()));
    if (texels < kFewestTexels) throw FileError(options.output, "would not fit into --max-megabytes");
    refuseTooLarge(options, loaded.scene);
    // How well light is compressed shows when it is there.
    constexpr int kAttempts = 3;
    for (int attempt = 1;; ++attempt) {
        try {
            return bakeOnce(options, source, loaded);
        } catch (const FileTooLarge& error) {
            texels = uint64_t(0.97 * double(texels) * double(*options.mostBytes) / double(error.bytes));
            if (attempt == kAttempts || texels < kFewestTexels)
                throw FileError(error.path, error.reason + ", more than --max-megabytes");
            if (!options.quiet) fmt::print(stderr, "{}; once more with {} texels\n", error.what(), texels);
        }
    }
}

}  // namespace

void addBakeCommand(CLI::App& app) {
    const BakeSettings defaults;
    CLI::App* command = app.add_subcommand("bake", "Bake a scene's indirect light into a file");
    const auto option = [&](const char* name, const char* type, const std::string& help) {
        return command->add_option(name, help)->type_name(type);
    };
    CLI::Option* input = option("IN", "FILE", "The scene: .glb or .gltf")->required();
    CLI::Option* output = option("-o,--output", "FILE", "Default: IN with the extension .phat.glb");
    CLI::Option* texelSize =
        option("--texel-size", "METERS", "Side of a PHATexel on the surface")->check(CLI::Range(1e-5, 1e3));
    CLI::Option* resolution = option("--resolution", "N", "About so many texels in the whole atlas")
                                  ->default_str("1048576")
                                  ->excludes(texelSize);
    CLI::Option* glossyDensity = option("--glossy-density", "F",
                                        "Texels of glossy surfaces may be up to F times finer, 1 to 8; "
                                        "default: 3, with --texel-size 1");
    CLI::Option* samples = option("--samples", "K", "PHATexels per texel")
                               ->check(CLI::Range(1, 64))
                               ->default_val(defaults.layers);
    CLI::Option* photons = option("--photons", "N", "Photons to emit")->default_str("500k");
    CLI::Option* neighbors = option("--gather-neighbors", "K", "Photons in a density estimate")
                                 ->check(CLI::Range(1, 10'000))
                                 ->default_val(defaults.density.neighbors);
    CLI::Option* directions =
        option("--directions", "NAME", "guided, photons, nearest-photon, uniform or cosine")
            ->check(CLI::IsMember(directionNames()))
            ->default_val("guided");
    CLI::Option* radiance = option("--radiance", "NAME", "texels, path, photons or splat")
                                ->check(CLI::IsMember(radianceNames()))
                                ->default_val("texels");
    CLI::Option* bounces = option("--bounces,--max-bounces", "N", "Longest path, in reflections")
                               ->check(CLI::Range(1, 1000))
                               ->default_val(defaults.maxBounces);
    CLI::Option* paths =
        option("--paths", "N", "Paths per PHATexel (--radiance texels: through glossy reflections; path)")
            ->check(CLI::Range(1, 65'536))
            ->default_val(defaults.pathsPerPhatexel);
    CLI::Option* environment = option("--environment", "FILE", "Sky: latitude-longitude .hdr or .exr");
    CLI::Option* useUv = option("--use-uv", "N", "Take the charts of TEXCOORD_N instead of unwrapping")
                             ->check(CLI::Range(0, 1));
    CLI::Option* gutter = option("--gutter", "N", "Texels around every chart at least")
                              ->check(CLI::Range(1, 64))
                              ->default_val(defaults.atlas.gutterTexels);
    CLI::Option* seed = option("--seed", "S", "Of all random numbers")
                            ->check(CLI::NonNegativeNumber)
                            ->default_val(defaults.seed);
    CLI::Option* threads = option("--threads", "T", "Default: all cores")->check(CLI::Range(1, 1024));
    CLI::Option* memory =
        option("--memory-limit", "GB", "Refuse to start a larger bake; default: the machine's")
            ->check(CLI::Range(0.001, 1e6));
    CLI::Option* megabytes = option("--max-megabytes", "MB", "Fewer texels, so that the file is no larger")
                                 ->check(CLI::Range(0.01, 4e3))
                                 ->excludes(texelSize);
    CLI::Option* resume = command->add_flag("--resume")->description("Go on where a stopped bake was");
    CLI::Option* quiet = command->add_flag("--quiet")->description("Print errors only");
    CLI::Option* asJson = command->add_flag("--json")->description("Print the result as JSON");
    command->footer(
        "Counts may end in k or M. The same input, flags and seed give the same bytes on any number of "
        "threads.\n"
        "Example: phat bake room.glb --texel-size 0.005 --samples 2");
    command->callback([=] {
        BakeOptions options;
        options.input = input->as<std::string>();
        options.output = *output ? output->as<std::string>() : defaultOutput(options.input);
        if (*environment) options.environment = environment->as<std::string>();
        BakeSettings& settings = options.settings;
        if (*texelSize) settings.atlas.texelSizeMeters = texelSize->as<float>();
        settings.atlas.glossyDensity = glossyDensityOf(*glossyDensity, texelSize->count() > 0);
        if (*resolution) settings.atlas.texelBudget = parseCount(resolution, kFewestTexels, 0x1p32);
        if (*photons) settings.photons.count = parseCount(photons, 1, 0x1p32);
        if (*useUv) settings.atlas.useUvSet = useUv->as<int>();
        settings.atlas.gutterTexels = gutter->as<uint32_t>();
        settings.layers = samples->as<int>();
        settings.density.neighbors = neighbors->as<uint32_t>();
        settings.directions = directionNames().at(directions->as<std::string>());
        settings.radiance = radianceNames().at(radiance->as<std::string>());
        if (settings.radiance == RadianceSource::splat && !choosesPhotons(settings.directions))
            throw CLI::ValidationError("--radiance", "splat needs --directions photons or nearest-photon");
        settings.maxBounces = bounces->as<int>();
        if (*bounces) settings.photons.maxBounces = settings.maxBounces;
        settings.pathsPerPhatexel = paths->as<int>();
        settings.seed = settings.photons.seed = seed->as<uint64_t>();
        if (*megabytes) options.mostBytes = uint64_t(megabytes->as<double>() * 1e6);
        if (*threads) options.threads = threads->as<int>();
        options.memoryLimitBytes = *memory ? memory->as<double>() * 1e9 : physicalMemoryBytes();
        options.resume = resume->count() > 0;
        options.quiet = quiet->count() > 0;
        options.json = asJson->count() > 0;
        runBake(options);
    });
}

}  // namespace phat
