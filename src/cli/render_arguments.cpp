#include "cli/render_arguments.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "cli/count_option.h"
#include "cli/declare_option.h"
#include "cli/exposure.h"
#include "cli/lighting_options.h"
#include "cli/render_files.h"
#include "cli/size_option.h"

namespace phat {
namespace {

constexpr double kMaxAnimationSeconds = 1e6;
constexpr std::array<FlagName<PixelFilter>, 2> kFilterNames = {
    {{"box", PixelFilter::box}, {"center", PixelFilter::center}}};
constexpr std::array<FlagName<Tracer>, 3> kTracerNames = {
    {{"auto", Tracer::automatic}, {"gpu", Tracer::gpu}, {"cpu", Tracer::cpu}}};
constexpr int kMaxDrawnSamples = 4096, kMaxTracedSamples = 65536;
constexpr int kMaxRefinements = 1000;

std::vector<std::string> methodNames() {
    std::vector<std::string> names;
    for (const RenderMethod& method : kRenderMethods) names.push_back(method.name);
    return names;
}

RenderMethod methodNamed(const std::string& name) {
    return *std::find_if(std::begin(kRenderMethods), std::end(kRenderMethods),
                         [&](const RenderMethod& method) { return method.name == name; });
}

glm::vec3 parsePoint(const CLI::Option& option) {
    const auto text = option.as<std::string>();
    glm::vec3 p(0);
    char end = 0;
    if (std::sscanf(text.c_str(), "%f,%f,%f%c", &p.x, &p.y, &p.z, &end) != 3 ||
        !std::isfinite(p.x + p.y + p.z))
        throw CLI::ValidationError(option.get_name(), fmt::format("\"{}\" is not x,y,z", text));
    return p;
}

/// START:END in seconds.
void parseTimes(const CLI::Option& option, AnimatedFrames& frames) {
    const auto text = option.as<std::string>();
    char end = 0;
    if (std::sscanf(text.c_str(), "%lf:%lf%c", &frames.start, &frames.end, &end) != 2 ||
        !(std::abs(frames.start) <= kMaxAnimationSeconds && std::abs(frames.end) <= kMaxAnimationSeconds) ||
        frames.end < frames.start)
        throw CLI::ValidationError(option.get_name(),
                                   fmt::format("\"{}\" is not START:END in seconds", text));
}

void declareFiles(const DeclareOption& declare, RenderOptions& options) {
    declare
        .value("IN", "FILE", options.input, "A baked file or a scene; methods that need a bake make it first")
        ->required();
    declare.value("-o,--output", "FILE", options.output, "The picture: .exr (linear), .png or .jpg")
        ->required();
    declare.command
        .add_option_function<std::string>(
            "--method", [&options](const std::string& name) { options.method = methodNamed(name); },
            fmt::format("{}", fmt::join(methodNames(), ", ")))
        ->type_name("NAME")
        ->check(CLI::IsMember(methodNames()))
        ->default_str(options.method.name);
}

void declareCamera(const DeclareOption& declare, RenderOptions& options) {
    declare.value("--camera", "NAME", options.camera,
                  "Name or index, or all: NAME goes into the output's; default: the first");
    declare.text("--eye", "X,Y,Z", "Where the eye is");
    declare.text("--target", "X,Y,Z", "What it looks at");
    declare.value("--fov", "DEGREES", options.fovDegrees, "Vertical field of view")
        ->check(CLI::Range(0.1, 179.0));
    declare.text("--size", "WxH", "Default: 960 wide, the height from the camera");
}

void declareSampling(const DeclareOption& declare, RenderOptions& options) {
    CLI::Option* spp = declare
                           .value("--spp", "N", options.samplesPerPixel,
                                  "Samples a pixel; default: 4; path: 64; phat-gather and photons-gather: 1")
                           ->check(CLI::Range(1, kMaxTracedSamples));
    declare
        .value("--time", "SECONDS", options.seconds,
               "Traced methods: as many samples as fit, instead of --spp")
        ->check(CLI::Range(0.001, 1e6))
        ->excludes(spp);
    declare.choice("--pixel-filter", kFilterNames, options.filter,
                   "What samples show: box, all of a pixel; center, its middle");
    declare.value("--seed", "S", options.seed, "Traced methods: of all random numbers; default: 1")
        ->check(CLI::NonNegativeNumber);
    declare.value("--threads", "T", options.threads, "Default: all cores")->check(CLI::Range(1, 1024));
    declare.value("--variance", "FILE", options.varianceOutput,
                  "Traced methods: the variance of each pixel's mean, .exr");
    declare.value("--pixels", "FILE", options.pixels,
                  "Traced methods: only those above 0.5 in this picture, the rest black");
}

void declareMethods(const DeclareOption& declare, RenderOptions& options) {
    declare.text("--photons", "N", "photons-direct, photons-gather: photons to emit; default: 500k");
    declare
        .value("--gather-neighbors", "K", options.photonRenderer.density.neighbors,
               "The same: photons in a density estimate")
        ->check(CLI::Range(1, 10'000))
        ->capture_default_str();
    declare
        .value("--gather-rays", "N", options.photonRenderer.gatherRays,
               "photons-gather: rays a sample of a pixel")
        ->check(CLI::Range(1, 65'536))
        ->capture_default_str();
    declare
        .value(
            "--radius", "METERS", options.gather.radiusMeters,
            "phat-gather: the paper's filter of this radius; default: by the distance of what is reflected")
        ->check(CLI::PositiveNumber);
    declare.flag("--trace-visibility", options.gather.traceVisibility,
                 "phat-gather: test visibility by rays, not by neighbouring PHATexels");
    declare.choice(
        "--reflections", kReflectionNames, options.reflections,
        "phat: auto traces rays for what PHATexels are too coarse for; rays for all; lookup for none");
    declare.choice("--trace", kTracerNames, options.tracer,
                   "phat: which processor traces them; auto is gpu, unless OpenGL is drawn in software");
    declare.choice("--component", kComponentNames, options.component,
                   "all, direct, indirect, glossy-indirect or diffuse-indirect");
    declare.choice("--quality", kQualityNames, options.quality, "phat: fast, default or high");
    declare.flag("--count-reads", options.countReads,
                 "phat: draw and report the texels read for indirect glossy light, with --spp 1");
}

void declareFrames(const DeclareOption& declare, RenderOptions& options) {
    CLI::Option* animate = declare.text(
        "--animate", "START:END", "phat: frames of the file's animation, in seconds; NAME.0000.png ...");
    declare.text("--fps", "N", "--animate: frames a second; default: 24")
        ->check(CLI::Range(0.001, 1000.0))
        ->needs(animate);
    CLI::Option* seconds =
        declare.text("--seconds-per-frame", "S", "--animate: time for the light to follow; default: 1")
            ->check(CLI::Range(0.0, 1e6))
            ->needs(animate);
    declare.text("--work-per-frame", "N", "The same in rays: the same pictures on every machine")
        ->needs(animate)
        ->excludes(seconds);
    declare.text("--animation", "NAME", "--animate: name or index; default: the first")->needs(animate);
    declare
        .value("--refine", "N", options.refinements,
               "phat: bake N times more, with other draws; the mean, of --spp samples each")
        ->check(CLI::Range(0, kMaxRefinements))
        ->excludes(animate);
    declare
        .flag("--follow", options.follow,
              "phat: with --camera all: the cameras are frames of one moving view, in their order; the rays "
              "of earlier frames count, traced by the GPU")
        ->excludes("--animate", "--refine", "--trace");
}

void declareScene(const DeclareOption& declare, RenderOptions& options) {
    declareLighting(declare, options.lighting);
    declare
        .value("--with", "FILE", options.things,
               "Things that are not in the bake, where their own file puts them; again for more files. They "
               "are lit by the bake's probes and by lights, cast these lights' shadows, and reflect blurrily")
        ->allow_extra_args(false)
        ->excludes("--animate", "--refine");
    declare.value("--variant", "NAME", options.variant,
                  "Material variant of a scene that is not baked; phat info lists them");
    declare
        .value("--set", "MATERIAL.PROPERTY=VALUE", options.edits,
               "Changes a material, e.g. floor.roughness=0.3; a name with = in double quotes: "
               "'\"a=b\".roughness=0.3'")
        ->expected(1, -1)
        ->excludes("--refine");  // edits would be visible at once and lit from the next pass on
    declare.flag("--keep-light", options.keepLight,
                 "Methods without a bake: --set changes what the eye meets, not the light on it");
}

void declareOutput(const DeclareOption& declare, RenderOptions& options) {
    declareExposure(declare.command, options.exposureStops);
    declare.choice("--tonemap", kToneMapNames, options.toneMap, "linear, agx or aces, for .png and .jpg");
    declare.flag("--quiet", options.quiet, "Print errors only");
    declare.flag("--json", options.json, "Print sizes and times as JSON");
}

/// Refuses flags that the method would ignore.
void checkMethod(const CLI::App& command, const RenderMethod& method) {
    const auto given = [&](const char* name) { return command.get_option(name)->count() > 0; };
    if (!method.traced) {
        for (const char* name : {"--time", "--seed", "--variance", "--pixels"})
            if (given(name))
                throw CLI::ValidationError(name,
                                           fmt::format("--method {} is drawn, not traced", method.name));
        if (given("--spp") && command.get_option("--spp")->as<int>() > kMaxDrawnSamples)
            throw CLI::ValidationError("--spp", fmt::format("at most {} when drawn", kMaxDrawnSamples));
    }
    const std::string_view name = method.name;
    const auto onlyFor = [&](std::initializer_list<const char*> flags, bool fits) {
        for (const char* flag : flags)
            if (!fits && given(flag))
                throw CLI::ValidationError(flag, fmt::format("means nothing to --method {}", name));
    };
    onlyFor({"--photons", "--gather-neighbors"}, method.readsPhotons);
    onlyFor({"--gather-rays"}, name == "photons-gather");
    onlyFor({"--keep-light"}, !method.needsBake);
    onlyFor({"--with"}, !method.traced);
    onlyFor({"--radius", "--trace-visibility"}, name == "phat-gather");
    onlyFor({"--quality", "--count-reads", "--reflections", "--trace", "--follow", "--animate", "--refine"},
            name == "phat");
}

AnimatedFrames animatedFrames(const CLI::App& command) {
    AnimatedFrames frames;
    const auto option = [&](const char* name) -> const CLI::Option& { return *command.get_option(name); };
    parseTimes(option("--animate"), frames);
    if (option("--fps")) frames.perSecond = option("--fps").as<double>();
    if (option("--animation")) frames.animation = option("--animation").as<std::string>();
    if (option("--work-per-frame"))
        frames.workPerFrame = double(parseCount(&option("--work-per-frame"), 0, 1e15));
    else
        frames.secondsPerFrame =
            option("--seconds-per-frame") ? option("--seconds-per-frame").as<double>() : 1.0;
    return frames;
}

}  // namespace

void declareRenderOptions(CLI::App& command, RenderOptions& options) {
    const DeclareOption declare{command};
    declareFiles(declare, options);
    declareCamera(declare, options);
    declareSampling(declare, options);
    declareMethods(declare, options);
    declareFrames(declare, options);
    declareScene(declare, options);
    declareOutput(declare, options);
}

void finishRenderOptions(const CLI::App& command, RenderOptions& options) {
    const auto option = [&](const char* name) -> const CLI::Option& { return *command.get_option(name); };
    if (option("--eye")) options.eye = parsePoint(option("--eye"));
    if (option("--target")) options.target = parsePoint(option("--target"));
    if (option("--size")) {
        const glm::ivec2 pixels = parseSize(&option("--size"));
        options.width = pixels.x;
        options.height = pixels.y;
    }
    checkMethod(command, options.method);
    if (options.follow && options.camera != kAllCameras)
        throw CLI::ValidationError("--follow", "needs --camera all");
    if (options.follow) options.tracer = Tracer::gpu;
    if (option("--animate")) options.animated = animatedFrames(command);
    if (!option("--spp")) options.samplesPerPixel = options.method.samplesPerPixel;
    if (options.countReads) options.samplesPerPixel = 1;
    if (option("--photons")) options.photons = parseCount(&option("--photons"), 1, 0x1p32);
}

}  // namespace phat
