// phat bench: how fast this machine draws a bake.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>

#include "cli/commands.h"
#include "cli/data_folders.h"
#include "cli/declare_option.h"
#include "cli/frame_bench.h"
#include "cli/interrupt.h"
#include "cli/progress_bar.h"
#include "cli/render_camera.h"
#include "cli/render_files.h"
#include "cli/size_option.h"
#include "gl/gl_context.h"

namespace phat {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kOwnScene = "tabletop.glb";
constexpr int kMaxFrames = 10'000;

struct BenchOptions {
    RenderOptions render;
    int frames = 32;
    bool table = false;
};

Json runBench(BenchOptions options) {
    std::string& input = options.render.input;
    if (input.empty()) input = sceneFolder() + "/" + kOwnScene;
    catchInterrupts();
    ProgressBar progress(progressStyle(options.render.quiet), {});
    SceneFile file = loadBaked(options.render, progress);
    BakedScene& baked = file.baked;
    const View view = chooseViews(options.render, baked.loaded.scene).front();

    const HeadlessContext context;
    const Scene& scene = baked.loaded.scene;
    const bool traces = options.render.reflections != Reflections::lookup;
    const SceneBvh* bvh = traces ? bvhOf(scene, baked.bvh) : nullptr;
    Renderer renderer({scene, baked.atlas, baked.points, baked.phatexture, bvh}, shaderFolder());
    FrameSettings frame = frameOf(options.render, view);
    frame.tracedByGpu = options.render.reflections;
    Json report{{"program", "phat " PHAT_VERSION},
                {"gpu", context.gpuName()},
                {"driver", context.versionName()},
                {"scene", std::filesystem::path(input).filename().string()},
                {"triangles", baked.loaded.scene.triangles.size()},
                {"texels", baked.atlas.texelCount()},
                {"width", view.width},
                {"height", view.height},
                {"reflections", nameOf(kReflectionNames, options.render.reflections)},
                {"quality", nameOf(kQualityNames, options.render.quality)},
                {"frames", options.frames}};
    report.update(benchFrames(renderer, frame, {options.frames, baked.atlas.unitMeters}, progress));
    return report;
}

void printTable(const Json& report) {
    const auto line = [](const std::string& label, const std::string& text) {
        fmt::print("{:<12}{}\n", label, text);
    };
    line("GPU", report["gpu"].get<std::string>());
    line("driver", report["driver"].get<std::string>());
    line("scene", fmt::format("{}, {} triangles, {} texels", report["scene"].get<std::string>(),
                              report["triangles"].get<size_t>(), report["texels"].get<size_t>()));
    line("picture", fmt::format("{} x {}, quality {}, medians of {} frames", report["width"].get<int>(),
                                report["height"].get<int>(), report["quality"].get<std::string>(),
                                report["frames"].get<int>()));
    const auto time = [&](const std::string& label, const Json& milliseconds) {
        line(label, fmt::format("{:9.3f} ms", milliseconds.get<double>()));
    };
    for (const auto& [pass, milliseconds] : report["passMilliseconds"].items())
        time("  " + pass, milliseconds);
    time("all passes", report["gpuMilliseconds"]);
    time("by clock", report["frameMilliseconds"]);
    if (report.contains("raysPerPixel")) {
        line("rays", fmt::format("{:9.2f} a pixel", report["raysPerPixel"].get<double>()));
        line("", fmt::format("{:9.1f} million a second", 1e-6 * report["raysPerSecond"].get<double>()));
    }
    if (report.contains("fetchesPerPixel"))
        line("", fmt::format("{:9.1f} fetches a pixel", report["fetchesPerPixel"].get<double>()));
    if (!report.contains("reads")) return;
    for (const auto& [source, reads] : report["reads"].items())
        line("reads", fmt::format("{:9.1f} a pixel, at most {:.0f}, of {} light", reads["mean"].get<double>(),
                                  reads["max"].get<double>(), source));
}

}  // namespace

void addBenchCommand(CLI::App& app) {
    CLI::App* command = app.add_subcommand("bench", "Measure how fast this machine draws a bake");
    const auto options = std::make_shared<BenchOptions>();
    options->render.width = 1280;
    options->render.height = 720;
    const DeclareOption declare{*command};
    declare.value("FILE", "FILE", options->render.input,
                  "A baked file or a scene, which is baked first; default: scenes/tabletop.glb");
    CLI::Option* size = declare.text("--size", "WxH", "Default: 1280x720");
    declare.value("--frames", "N", options->frames, "How many are measured")
        ->check(CLI::Range(1, kMaxFrames))
        ->capture_default_str();
    declare.choice("--quality", kQualityNames, options->render.quality, "fast, default or high");
    declare.choice("--reflections", kReflectionNames, options->render.reflections,
                   "auto traces rays for what PHATexels are too coarse for; rays for all; lookup for none");
    declare.flag("--table", options->table, "Print a table instead of JSON");
    declare.flag("--quiet", options->render.quiet, "No progress");
    command->footer(
        "The view moves to and fro; each frame is of one sample a pixel. Times are medians by the GPU's "
        "clock,\n"
        "in milliseconds. raysPerSecond: reflection rays over the time of all passes that rays need.\n"
        "Example: phat bench --table");
    command->callback([=] {
        if (*size) {
            const glm::ivec2 pixels = parseSize(size);
            options->render.width = pixels.x;
            options->render.height = pixels.y;
        }
        const Json report = runBench(*options);
        if (options->table)
            printTable(report);
        else
            fmt::print("{}\n", report.dump(2, ' ', false, Json::error_handler_t::replace));
    });
}

}  // namespace phat
