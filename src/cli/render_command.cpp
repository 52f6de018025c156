// phat render: pictures of a scene, from its bake or by tracing rays.

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <tbb/global_control.h>

#include <CLI/CLI.hpp>

#include "cli/bake_stages.h"
#include "cli/commands.h"
#include "cli/count_option.h"
#include "cli/interrupt.h"
#include "cli/render_files.h"
#include "cli/render_methods.h"
#include "cli/size_option.h"
#include "gl/flag_names.h"

namespace phat {
namespace {

using nlohmann::json;

constexpr double kMostAnimationSeconds = 1e6;
constexpr std::array<FlagName<PixelFilter>, 2> kFilterNames = {
    {{"box", PixelFilter::box}, {"center", PixelFilter::center}}};
constexpr int kMaxDrawnSamples = 4096, kMaxTracedSamples = 65536;
constexpr int kMostRefinements = 1000;

std::vector<std::string> methodNames() {
    std::vector<std::string> names;
    for (const RenderMethod& method : kRenderMethods) names.push_back(method.name);
    return names;
}

RenderMethod methodNamed(const std::string& name) {
    return *std::find_if(std::begin(kRenderMethods), std::end(kRenderMethods),
                         [&](const RenderMethod& method) { return method.name == name; });
}

glm::vec3 parsePoint(const CLI::Option* option) {
    const auto text = option->as<std::string>();
    glm::vec3 p(0);
    char end = 0;
    if (std::sscanf(text.c_str(), "%f,%f,%f%c", &p.x, &p.y, &p.z, &end) != 3 ||
        !std::isfinite(p.x + p.y + p.z))
        throw CLI::ValidationError(option->get_name(), fmt::format("\"{}\" is not x,y,z", text));
    return p;
}

/// START:END in seconds.
void parseTimes(const CLI::Option* option, AnimatedFrames& frames) {
    const auto text = option->as<std::string>();
    char end = 0;
    if (std::sscanf(text.c_str(), "%lf:%lf%c", &frames.start, &frames.end, &end) != 2 ||
        !(std::abs(frames.start) <= kMostAnimationSeconds && std::abs(frames.end) <= kMostAnimationSeconds) ||
        frames.end < frames.start)
        throw CLI::ValidationError(option->get_name(),
                                   fmt::format("\"{}\" is not START:END in seconds", text));
}

void printReport(const json& report, bool traced) {
    fmt::print("{}: {} x {}, ", report["output"].get<std::string>(), report["width"].get<int>(),
               report["height"].get<int>());
    const json& seconds = report["seconds"];
    const auto milliseconds = [&](std::initializer_list<const char*> passes) {
        double sum = 0;
        for (const char* pass : passes) sum += 1e3 * seconds[pass].get<double>();
        return sum;
    };
    if (traced)
        fmt::print("{} samples a pixel, {:.2f} s, {:.2f} million rays/s\n",
                   report["samplesPerPixel"].get<int>(), seconds.get<double>(),
                   report["raysPerSecond"].get<double>() * 1e-6);
    else
        fmt::print(
            "relight {:.1f} ms, pyramid {:.1f} ms, shadows {:.1f} ms, lookup {:.1f} ms, display {:.1f} ms, "
            "reflections {:.1f} ms ({:.2f} million rays)\n",
            milliseconds({"relight"}), milliseconds({"pyramid"}), milliseconds({"shadows"}),
            milliseconds({"lookup", "pool"}), milliseconds({"depth", "display"}),
            milliseconds({"reflections"}), report["reflectionRays"].get<double>() * 1e-6);
    if (report.contains("bytesPerPhatexel"))
        fmt::print("lookup: {:.1f} bytes a PHATexel\n", report["bytesPerPhatexel"].get<double>());
    if (report.contains("reads"))
        for (const char* source : {"indirect", "area"})
            fmt::print("reads a pixel, {} light: {:.1f} in the mean, {} at most\n", source,
                       report["reads"][source]["mean"].get<double>(),
                       report["reads"][source]["max"].get<double>());
}

void runRender(const RenderOptions& options) {
    checkPlaces(options);
    std::optional<tbb::global_control> threads;
    if (options.threads)
        threads.emplace(tbb::global_control::max_allowed_parallelism, size_t(*options.threads));
    catchInterrupts();
    std::vector<json> reports;
    {
        ProgressBar progress(progressStyle(options.quiet), options.method.needsBake
                                                               ? bakeStages(BakeSettings())
                                                               : std::vector<PlannedStage>{{"trace", 1}});
        reports = options.animated          ? renderAnimated(options, progress)
                  : options.refinements > 0 ? renderRefined(options, progress)
                  : options.method.traced   ? renderTraced(options, progress)
                                            : renderDrawn(options, progress);
    }
    if (options.json) {
        const json all = reports.size() == 1 ? reports.front() : json(reports);
        fmt::print("{}\n", all.dump(-1, ' ', false, json::error_handler_t::replace));
    } else if (!options.quiet) {
        for (const json& report : reports) printReport(report, options.method.traced);
    }
}

}  // namespace

void addRenderCommand(CLI::App& app) {
    CLI::App* command = app.add_subcommand("render", "Make a picture of a scene or a baked file");
    const auto option = [&](const char* name, const char* type, const std::string& help) {
        return command->add_option(name, help)->type_name(type);
    };
    CLI::Option* input =
        option("IN", "FILE", "A baked file or a scene; methods that need a bake make it first")->required();
    CLI::Option* output =
        option("-o,--output", "FILE", "The picture: .exr (linear), .png or .jpg")->required();
    CLI::Option* method = option("--method", "NAME", fmt::format("{}", fmt::join(methodNames(), ", ")))
                              ->check(CLI::IsMember(methodNames()))
                              ->default_val(kRenderMethods[0].name);
    CLI::Option* camera =
        option("--camera", "NAME", "Name or index, or all: NAME goes into the output's; default: the first");
    CLI::Option* eye = option("--eye", "X,Y,Z", "Where the eye is");
    CLI::Option* target = option("--target", "X,Y,Z", "What it looks at");
    CLI::Option* fov = option("--fov", "DEGREES", "Vertical field of view")->check(CLI::Range(0.1, 179.0));
    CLI::Option* size = option("--size", "WxH", "Default: 960 wide, the height from the camera");
    CLI::Option* spp =
        option("--spp", "N", "Samples a pixel; default: 4; path: 64; phat-gather and photons-gather: 1")
            ->check(CLI::Range(1, kMaxTracedSamples));
    CLI::Option* time =
        option("--time", "SECONDS", "Traced methods: as many samples as fit, instead of --spp")
            ->check(CLI::Range(0.001, 1e6))
            ->excludes(spp);
    CLI::Option* filter =
        option("--pixel-filter", "NAME", "What samples show: box, all of a pixel; center, its middle")
            ->check(CLI::IsMember(namesOf(kFilterNames)))
            ->default_val("box");
    CLI::Option* seed = option("--seed", "S", "Traced methods: of all random numbers; default: 1")
                            ->check(CLI::NonNegativeNumber);
    CLI::Option* threads = option("--threads", "T", "Default: all cores")->check(CLI::Range(1, 1024));
    CLI::Option* variance =
        option("--variance", "FILE", "Traced methods: the variance of each pixel's mean, .exr");
    CLI::Option* pixelMask =
        option("--pixels", "FILE", "Traced methods: only those above 0.5 in this picture, the rest black");
    CLI::Option* photons =
        option("--photons", "N", "photons-direct, photons-gather: photons to emit; default: 500k");
    CLI::Option* neighbors = option("--gather-neighbors", "K", "The same: photons in a density estimate")
                                 ->check(CLI::Range(1, 10'000))
                                 ->default_val(DensityEstimate().neighbors);
    CLI::Option* gatherRays = option("--gather-rays", "N", "photons-gather: rays a sample of a pixel")
                                  ->check(CLI::Range(1, 65'536))
                                  ->default_val(PhotonRendererSettings().gatherRays);
    CLI::Option* radius = option("--radius", "METERS",
                                 "phat-gather: the paper's filter of this radius; default: by what is seen")
                              ->check(CLI::Range(1e-4, 1e3));
    CLI::Option* traceVisibility =
        command->add_flag("--trace-visibility")
            ->description("phat-gather: ask the scene, not neighbouring PHATexels, what is in the way");
    CLI::Option* reflections =
        option("--reflections", "HOW",
               "phat: auto traces rays for what PHATexels are too coarse for; rays for all; lookup for none")
            ->check(CLI::IsMember(namesOf(kReflectionNames)))
            ->default_val("auto");
    CLI::Option* component =
        option("--component", "NAME", "all, direct, indirect, glossy-indirect or diffuse-indirect")
            ->check(CLI::IsMember(namesOf(kComponentNames)))
            ->default_val("all");
    CLI::Option* quality = option("--quality", "NAME", "phat: fast, default or high")
                               ->check(CLI::IsMember(namesOf(kQualityNames)))
                               ->default_val("default");
    CLI::Option* countReads =
        command->add_flag("--count-reads")
            ->description("phat: draw and report the texels read for indirect glossy light, with --spp 1");
    CLI::Option* animate = option("--animate", "START:END",
                                  "phat: frames of the file's animation, in seconds; NAME.0000.png ...");
    CLI::Option* fps = option("--fps", "N", "--animate: frames a second; default: 24")
                           ->check(CLI::Range(0.001, 1000.0))
                           ->needs(animate);
    CLI::Option* secondsPerFrame =
        option("--seconds-per-frame", "S", "--animate: time for the light to follow; default: 1")
            ->check(CLI::Range(0.0, 1e6))
            ->needs(animate);
    CLI::Option* workPerFrame =
        option("--work-per-frame", "N", "The same in rays: the same pictures on every machine")
            ->needs(animate)
            ->excludes(secondsPerFrame);
    CLI::Option* animation =
        option("--animation", "NAME", "--animate: name or index; default: the first")->needs(animate);
    CLI::Option* refine =
        option("--refine", "N", "phat: bake N times more, with other draws; the mean, of --spp samples each")
            ->check(CLI::Range(0, kMostRefinements))
            ->excludes(animate);
    CLI::Option* environment =
        option("--environment", "FILE", "Sky of a scene that is not baked: latitude-longitude .hdr or .exr");
    CLI::Option* edits =
        option("--set", "MATERIAL.PROPERTY=VALUE", "Changes a material, e.g. floor.roughness=0.3")
            ->expected(1, -1)
            ->excludes(refine);  // edits would be seen at once and lit from the next pass on
    CLI::Option* keepLight =
        command->add_flag("--keep-light")
            ->description("Methods without a bake: --set changes what the eye meets, not the light on it");
    CLI::Option* exposure = option("--exposure", "EV", "Stops, for .png and .jpg")
                                ->check(CLI::Range(-40.0, 40.0))
                                ->default_val("0");
    CLI::Option* toneMapping = option("--tonemap", "NAME", "linear, agx or aces, for .png and .jpg")
                                   ->check(CLI::IsMember(namesOf(kToneMapNames)))
                                   ->default_val("agx");
    CLI::Option* quiet = command->add_flag("--quiet")->description("Print errors only");
    CLI::Option* asJson = command->add_flag("--json")->description("Print sizes and times as JSON");
    command->footer("Example: phat render room.phat.glb -o room.png --set floor.roughness=0.2 --exposure 1");
    command->callback([=] {
        RenderOptions options;
        options.method = methodNamed(method->as<std::string>());
        options.input = input->as<std::string>();
        options.output = output->as<std::string>();
        if (*camera) options.camera = camera->as<std::string>();
        if (*eye) options.eye = parsePoint(eye);
        if (*target) options.target = parsePoint(target);
        if (*fov) options.fovDegrees = fov->as<float>();
        if (*size) {
            const glm::ivec2 pixels = parseSize(size);
            options.width = pixels.x;
            options.height = pixels.y;
        }
        if (!options.method.traced) {
            for (const CLI::Option* traced : {time, seed, variance, pixelMask})
                if (*traced)
                    throw CLI::ValidationError(
                        traced->get_name(),
                        fmt::format("--method {} is drawn, not traced", options.method.name));
            if (*spp && spp->as<int>() > kMaxDrawnSamples)
                throw CLI::ValidationError("--spp", fmt::format("at most {} when drawn", kMaxDrawnSamples));
        }
        const std::string_view name = options.method.name;
        const auto onlyFor = [&](std::initializer_list<const CLI::Option*> given, bool fits) {
            for (const CLI::Option* one : given)
                if (!fits && one->count() > 0)
                    throw CLI::ValidationError(one->get_name(),
                                               fmt::format("means nothing to --method {}", name));
        };
        onlyFor({photons, neighbors}, options.method.readsPhotons);
        onlyFor({gatherRays}, name == "photons-gather");
        onlyFor({keepLight}, !options.method.needsBake);
        onlyFor({radius, traceVisibility}, name == "phat-gather");
        onlyFor({quality, countReads, reflections, animate, refine}, name == "phat");
        if (*refine) options.refinements = refine->as<int>();
        if (*animate) {
            AnimatedFrames& frames = options.animated.emplace();
            parseTimes(animate, frames);
            if (*fps) frames.perSecond = fps->as<double>();
            if (*animation) frames.animation = animation->as<std::string>();
            if (*workPerFrame)
                frames.workPerFrame = double(parseCount(workPerFrame, 0, 1e15));
            else
                frames.secondsPerFrame = *secondsPerFrame ? secondsPerFrame->as<double>() : 1.0;
        }
        options.quality = valueOf(kQualityNames, quality->as<std::string>());
        options.countReads = countReads->count() > 0;
        options.samplesPerPixel = *spp ? spp->as<int>() : options.method.samplesPerPixel;
        if (options.countReads) options.samplesPerPixel = 1;
        if (*time) options.seconds = time->as<double>();
        if (*seed) options.seed = seed->as<uint64_t>();
        if (*threads) options.threads = threads->as<int>();
        if (*photons) options.photons = parseCount(photons, 1, 0x1p32);
        options.photonRenderer.density.neighbors = neighbors->as<uint32_t>();
        options.photonRenderer.gatherRays = gatherRays->as<int>();
        if (*radius) options.gather.radiusMeters = radius->as<float>();
        options.reflections = valueOf(kReflectionNames, reflections->as<std::string>());
        options.gather.traceVisibility = traceVisibility->count() > 0;
        if (*variance) options.varianceOutput = variance->as<std::string>();
        if (*pixelMask) options.pixels = pixelMask->as<std::string>();
        options.filter = valueOf(kFilterNames, filter->as<std::string>());
        options.keepLight = keepLight->count() > 0;
        options.component = valueOf(kComponentNames, component->as<std::string>());
        if (*environment) options.environment = environment->as<std::string>();
        if (*edits) options.edits = edits->results();
        options.exposureStops = exposure->as<float>();
        options.toneMap = valueOf(kToneMapNames, toneMapping->as<std::string>());
        options.quiet = quiet->count() > 0;
        options.json = asJson->count() > 0;
        runRender(options);
    });
}

}  // namespace phat
