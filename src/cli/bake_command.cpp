// phat bake: scene in, baked file out.

#include <fmt/format.h>
#include <tbb/global_control.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>

#include "cli/bake_arguments.h"
#include "cli/bake_report.h"
#include "cli/bake_stages.h"
#include "cli/commands.h"
#include "cli/console.h"
#include "cli/interrupt.h"
#include "cli/lighting_options.h"
#include "cli/progress_bar.h"
#include "cli/size_note.h"
#include "core/base/random.h"
#include "core/scene/lights.h"
#include "io/base/atomic_file.h"
#include "io/base/file_error.h"
#include "io/base/machine_memory.h"
#include "io/gltf/gltf_source.h"
#include "io/phat/bake_journal.h"
#include "io/phat/bake_record.h"
#include "io/phat/baked_file.h"
#include "io/phat/earlier_file.h"
#include "io/phat/scene_file.h"

namespace phat {
namespace {

using nlohmann::json;

struct LitInput {
    LoadedScene loaded;
    AddedLighting added;
    std::unique_ptr<const EarlierFile> earlier;  // null: a bake of its own
};

LitInput loadInput(const BakeOptions& options, GltfSource& source) {
    if (isBakedFile(source) && !options.variant.empty())
        throw CLI::ValidationError("--variant", "the input is baked; choose it of the scene");
    std::unique_ptr<const EarlierFile> earlier;
    if (!options.earlier.empty())
        earlier = openEarlier(options.earlier,
                              recordOf(options.settings, options.input, options.lighting.environment));
    SceneFile file = readSceneFile(
        source, options.lighting, BakedLighting::replace,
        {options.variant, options.settings.atlas, earlier ? earlier->baked.inputs.wallTexelSizeMeters : 0});
    if (file.baked.loaded.scene.triangles.empty()) throw FileError(options.input, "has no triangles to bake");
    return {std::move(file.baked.loaded), std::move(file.added), std::move(earlier)};
}

// Upper estimate of what the program will hold at its worst moment. Throws where that is more than it may be.
uint64_t checkedMemory(const BakeOptions& options, const GltfSource& source, const Scene& scene) {
    constexpr uint64_t kCopies = 3;  // of the scene's file, when the baked file is made of it
    const ProcessMemory held = memoryOfProcess();
    const uint64_t needed = std::max(
        held.peak, held.now + kCopies * source.fileBytes + estimateBakeMemory(scene, options.settings));
    if (double(needed) > options.memoryLimitBytes)
        throw FileError(
            options.input,
            fmt::format("the bake would need about {:.2f} GB of memory, the limit is {:.2f} GB: a "
                        "larger --texel-size, a smaller --resolution or fewer --photons need less",
                        double(needed) * 1e-9, options.memoryLimitBytes * 1e-9));
    return needed;
}

uint64_t fingerprintOf(const BakeOptions& options, const GltfSource& source, const BakeRecord& record) {
    Fingerprint fingerprint;
    fingerprint.add(record.generator);
    fingerprint.add(record.settings);
    addGltf(fingerprint, source);
    for (const std::string& file : {options.lighting.environment, options.earlier})
        if (!file.empty()) addFile(fingerprint, file);
    for (const NamedPhotometry& photometry : options.lighting.photometries) {
        fingerprint.add(photometry.light);
        fingerprint.add(photometry.bytes);
        fingerprint.add(float(photometry.multiplier));
    }
    return fingerprint.value();
}

void checkOutput(const BakeOptions& options) {
    std::string extension = std::filesystem::path(options.output).extension().string();
    for (char& c : extension) c = char(std::tolower(uint8_t(c)));
    if (extension != ".glb")
        throw CLI::ValidationError("--output", fmt::format("\"{}\" does not end in .glb", options.output));
    std::error_code ignored;
    for (const std::string& input : {options.input, options.lighting.environment})
        if (std::filesystem::equivalent(input, options.output, ignored))
            throw CLI::ValidationError("--output", fmt::format("would overwrite the input {}", input));
    if (!options.outputGiven && std::filesystem::equivalent(options.earlier, options.output, ignored))
        throw CLI::ValidationError(
            "--output", fmt::format("would overwrite the earlier bake {}; say so with -o", options.earlier));
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

BakeRecord fullRecord(const BakeOptions& options, const AddedLighting& added) {
    BakeRecord record = recordOf(options.settings, options.input, options.lighting.environment,
                                 options.storage, options.variant, options.probes.count);
    record.settings = settingsWithLighting(record.settings, options.lighting, added.sky);
    return record;
}

struct BakedLight {
    Bake bake;
    LightProbes probes;
    BakedInputs inputs;
};

BakedLight bakeLight(const BakeOptions& options, const GltfSource& source, const LitInput& input,
                     const RayScene& rays, const ProbeRun& run) {
    std::optional<EarlierBake> earlier;
    if (input.earlier)
        earlier.emplace(earlierBake(*input.earlier, source, input.loaded.scene, options.takesResults));
    Bake result = bake(rays, options.settings, run.progress, run.journal, earlier ? &*earlier : nullptr);
    const uint64_t probesKey = hashOf(result.keys.all, uint64_t(options.probes.count), options.probes.seed);
    const bool sameProbes = result.stats.kept.all && sameKey(probesKey, input.earlier->baked.inputs.probes);
    LightProbes probes = sameProbes ? input.earlier->baked.probes
                                    : bakeLightProbes({rays, result.atlas, result.points, result.phatexture},
                                                      options.probes, run);
    const BakedInputs inputs{input.loaded.wallTexelSizeMeters, result.keys, probesKey};
    return {std::move(result), std::move(probes), inputs};
}

void bakeOnce(const BakeOptions& options, const GltfSource& source, const LitInput& input,
              const RayScene& rays, uint64_t estimatedBytes) {
    const LoadedScene& loaded = input.loaded;
    const BakeRecord record = fullRecord(options, input.added);
    const std::string journalPath = nameBeside(options.output, ".journal");
    FileJournal journal(journalPath, fingerprintOf(options, source, record), options.resume);
    if (!options.quiet && !journal.putAside().empty())
        tell(fmt::format("{}: the journal of an earlier bake is kept as {}\n", options.output,
                         journal.putAside()));
    json report;
    try {
        ProgressBar progress(progressStyle(options.quiet), bakeStages(options.settings, options.probes));
        std::atomic<uint64_t> probeRays = 0;
        const BakedLight light = bakeLight(options, source, input, rays, {progress, &journal, probeRays});
        const Bake& result = light.bake;
        const LightProbes& probes = light.probes;
        std::vector<std::string> notes = loaded.notes;
        if (const std::optional<std::string> note = sizeNote(loaded.scene)) notes.push_back(*note);
        for (std::string& note :
             writeBakedFile(options.output, source, loaded.scene, result, record,
                            {&progress, &probes, options.maxBytes.value_or(~uint64_t(0)), light.inputs}))
            notes.push_back(std::move(note));
        if (auto note = resolutionNote(result, options.settings.atlas)) notes.push_back(std::move(*note));
        report = reportOf(options.output, result, journal.resumedRecords(), progress.stageTimes(), notes);
        report["probes"] = {
            {"count", probes.count()}, {"bytes", probeBytes(probes)}, {"rays", probeRays.load()}};
        if (options.settings.dynamic && !result.stats.kept.all) report["dynamic"] = dynamicReport(result);
        if (input.earlier) report["kept"] = keptReport(result, *input.earlier);
        report["memory"] = {{"estimatedBytes", estimatedBytes}, {"peakBytes", memoryOfProcess().peak}};
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
        printReport(report, input.added.lines);
}

void runBake(BakeOptions options) {
    std::optional<tbb::global_control> threads;
    if (options.threads)
        threads.emplace(tbb::global_control::max_allowed_parallelism, size_t(*options.threads));
    catchInterrupts();

    GltfSource source = openGltf(options.input);  // kept: the baked file is rewritten from it
    checkOutput(options);
    const LitInput input = loadInput(options, source);
    const LoadedScene& loaded = input.loaded;
    if (!options.quiet) printLines(options.input, input.added.lines);
    uint64_t& texels = options.settings.atlas.texelBudget;
    const bool area = options.settings.dynamic || LightSampler(loaded.scene).hasArea();
    if (options.maxBytes)
        texels = std::min(texels, texelsThatFit(*options.maxBytes, std::filesystem::file_size(options.input),
                                                options.settings.layers, area, options.storage));
    if (texels < kMinTexels) throw FileError(options.output, "would not fit into --max-megabytes");
    const uint64_t estimatedBytes = checkedMemory(options, source, loaded.scene);
    const RayScene rays = raysOf(loaded.scene, input.added);
    // How well light is compressed shows when it is there.
    constexpr int kAttempts = 3;
    for (int attempt = 1;; ++attempt) {
        try {
            return bakeOnce(options, source, input, rays, estimatedBytes);
        } catch (const FileTooLarge& error) {
            texels = uint64_t(0.97 * double(texels) * double(*options.maxBytes) / double(error.bytes));
            if (attempt == kAttempts || texels < kMinTexels)
                throw FileError(error.path, error.reason + ", more than --max-megabytes");
            if (!options.quiet) tell(fmt::format("{}; once more with {} texels\n", error.what(), texels));
        }
    }
}

}  // namespace

void addBakeCommand(CLI::App& app) {
    CLI::App* command = app.add_subcommand("bake", "Bake a scene's indirect light into a file");
    const auto options = std::make_shared<BakeOptions>();
    declareBakeOptions(*command, *options);
    command->footer(
        "Counts may end in k or M. The same input, flags and seed give the same bytes on any number of "
        "threads.\n"
        "Example: phat bake room.glb --texel-size 0.005 --samples 2");
    command->callback([command, options] {
        finishBakeOptions(*command, *options);
        runBake(*options);
    });
}

}  // namespace phat
