#include "cli/bake_arguments.h"

#include <fmt/format.h>

#include <filesystem>

#include "cli/count_option.h"
#include "cli/lighting_options.h"
#include "core/atlas/glossy_density.h"
#include "io/base/machine_memory.h"
#include "io/phat/bake_record.h"

namespace phat {
namespace {

// Texels of a size that was asked for are of that size, unless the densities were asked for as well.
float glossyDensityOf(const CLI::Option& option, bool texelSizeGiven) {
    if (!option) return texelSizeGiven ? 1.0f : AtlasSettings().glossyDensity;
    const auto density = option.as<float>();
    if (!(density >= 1 && density <= kMaxGlossyDensity))  // CLI::Range lets nan pass
        throw CLI::ValidationError(
            option.get_name(), fmt::format("{} is not a density from 1 to {}", density, kMaxGlossyDensity));
    return density;
}

std::string defaultOutput(const std::string& input) {
    std::filesystem::path path(input);
    path.replace_extension();
    if (path.extension() == ".phat") path.replace_extension();
    return path.string() + ".phat.glb";
}

// With few bytes for all of the file, probes have a twentieth of them.
int probeCountOf(const CLI::Option& option, std::optional<uint64_t> maxBytes) {
    if (option && option.as<std::string>() == "none") return 0;
    if (option) return int(parseCount(&option, 8, double(kMaxProbes)));
    constexpr double kMaxOfFile = 0.05, kBytesOfProbe = 60;  // measured: compressed, with its cells
    const double most = maxBytes ? kMaxOfFile * double(*maxBytes) / kBytesOfProbe : 1e9;
    return most < 8 ? 0 : int(std::min(double(ProbeSettings().count), most));
}

void declareAtlas(const DeclareOption& declare, AtlasSettings& atlas) {
    CLI::Option* texelSize =
        declare.value("--texel-size", "METERS", atlas.texelSizeMeters, "Side of a PHATexel on the surface")
            ->check(CLI::PositiveNumber);
    declare.text("--resolution", "N", "About so many texels in the whole atlas")
        ->default_str("1048576")
        ->excludes(texelSize);
    declare.text("--glossy-density", "F",
                 "Texels of glossy surfaces may be up to F times finer, 1 to 8; "
                 "default: 3, with --texel-size 1");
    declare.text("--max-megabytes", "MB", "Fewer texels, so that the file is no larger")
        ->check(CLI::Range(0.01, 4e3))
        ->excludes(texelSize);
    declare.value("--use-uv", "N", atlas.useUvSet, "Take the charts of TEXCOORD_N instead of unwrapping")
        ->check(CLI::Range(0, 1));
    declare.value("--gutter", "N", atlas.gutterTexels, "Texels around every chart of one piece")
        ->check(CLI::Range(1, 64))
        ->capture_default_str();
}

void declareLight(const DeclareOption& declare, BakeSettings& settings) {
    declare.value("--samples", "K", settings.layers, "PHATexels per texel")
        ->check(CLI::Range(1, 64))
        ->capture_default_str();
    declare.text("--photons", "N", "Photons to emit")->default_str("500k");
    declare.value("--gather-neighbors", "K", settings.density.neighbors, "Photons in a density estimate")
        ->check(CLI::Range(1, 10'000))
        ->capture_default_str();
    declare.text("--directions", "NAME", "guided, photons, nearest-photon, uniform or cosine")
        ->check(CLI::IsMember(directionNames()))
        ->default_val("guided");
    declare.text("--radiance", "NAME", "texels, path, photons or splat")
        ->check(CLI::IsMember(radianceNames()))
        ->default_val("texels");
    declare.value("--bounces,--max-bounces", "N", settings.maxBounces, "Longest path, in reflections")
        ->check(CLI::Range(1, 1000))
        ->capture_default_str();
    declare
        .value("--paths", "N", settings.pathsPerPhatexel,
               "Paths per PHATexel (--radiance texels: through glossy reflections; path)")
        ->check(CLI::Range(1, 65'536))
        ->capture_default_str();
    declare.text("--probes", "COUNT",
                 "Points that light things which are added after the bake, at most so many; or none; "
                 "default: 2048");
    declare.flag(
        "--dynamic", settings.dynamic,
        "Also texels for sides that no light reaches yet, and for lamps that are off: they can light "
        "up later");
    declare.value("--seed", "S", settings.seed, "Of all random numbers")
        ->check(CLI::NonNegativeNumber)
        ->capture_default_str();
}

}  // namespace

void declareBakeOptions(CLI::App& command, BakeOptions& options) {
    const DeclareOption declare{command};
    declare.value("IN", "FILE", options.input, "The scene: .glb or .gltf")->required();
    declare.value("-o,--output", "FILE", options.output, "Default: IN with the extension .phat.glb");
    declareLighting(declare, options.lighting);
    declare.value("--variant", "NAME", options.variant, "Material variant; phat info lists them");
    declareAtlas(declare, options.settings.atlas);
    declareLight(declare, options.settings);
    declare
        .text("--storage", "NAME",
              "packed: 8 bytes a PHATexel; paper: the paper's 16, without distances, to study it")
        ->check(CLI::IsMember(storageNames()))
        ->default_val("packed");
    CLI::Option* update = declare.value(
        "--update", "FILE", options.earlier,
        "An earlier bake of the scene: what has not changed is taken over; the result is that of --atlas-of");
    declare
        .value("--atlas-of", "FILE", options.earlier,
               "Bake anew, but with the charts of an earlier bake in their places")
        ->excludes(update);
    for (const char* name : {"--update", "--atlas-of"})
        for (const char* other : {"--max-megabytes", "--use-uv"})
            command.get_option(name)->excludes(command.get_option(other));
    declare.value("--threads", "T", options.threads, "Default: all cores")->check(CLI::Range(1, 1024));
    declare
        .text("--memory-limit", "GB",
              "Refuse to start a larger bake; default: the machine's, or its control group's")
        ->check(CLI::Range(0.001, 1e6));
    declare.flag("--resume", options.resume, "Go on where a stopped bake was");
    declare.flag("--quiet", options.quiet, "Print errors only");
    declare.flag("--json", options.json, "Print the result as JSON");
}

void finishBakeOptions(const CLI::App& command, BakeOptions& options) {
    const auto option = [&](const char* name) -> const CLI::Option& { return *command.get_option(name); };
    BakeSettings& settings = options.settings;
    options.outputGiven = option("--output").count() > 0;
    if (!options.outputGiven) options.output = defaultOutput(options.input);
    options.takesResults = option("--update").count() > 0;
    settings.atlas.glossyDensity =
        glossyDensityOf(option("--glossy-density"), option("--texel-size").count() > 0);
    if (option("--resolution"))
        settings.atlas.texelBudget = parseCount(&option("--resolution"), kMinTexels, 0x1p32);
    if (option("--photons")) settings.photons.count = parseCount(&option("--photons"), 1, 0x1p32);
    settings.directions = directionNames().at(option("--directions").as<std::string>());
    settings.radiance = radianceNames().at(option("--radiance").as<std::string>());
    options.storage = storageNames().at(option("--storage").as<std::string>());
    if (settings.radiance == RadianceSource::splat && !choosesPhotons(settings.directions))
        throw CLI::ValidationError("--radiance", "splat needs --directions photons or nearest-photon");
    if (option("--bounces")) settings.photons.maxBounces = settings.maxBounces;
    settings.photons.seed = settings.seed;
    if (option("--max-megabytes")) options.maxBytes = uint64_t(option("--max-megabytes").as<double>() * 1e6);
    options.probes = {probeCountOf(option("--probes"), options.maxBytes), settings.seed};
    options.memoryLimitBytes = option("--memory-limit") ? option("--memory-limit").as<double>() * 1e9
                                                        : double(memoryLimitOfMachine());
}

}  // namespace phat
