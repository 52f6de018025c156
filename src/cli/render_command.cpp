// phat render: pictures of a scene, from its bake or by tracing rays.

#include <fmt/format.h>
#include <tbb/global_control.h>

#include <CLI/CLI.hpp>

#include "cli/bake_stages.h"
#include "cli/commands.h"
#include "cli/exposure.h"
#include "cli/interrupt.h"
#include "cli/render_arguments.h"
#include "cli/render_files.h"
#include "cli/render_methods.h"

namespace phat {
namespace {

using nlohmann::json;

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
    if (report.contains("exposure")) fmt::print("{}\n", describeExposure(report["exposure"]));
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
    const auto options = std::make_shared<RenderOptions>();
    declareRenderOptions(*command, *options);
    command->footer("Example: phat render room.phat.glb -o room.png --set floor.roughness=0.2 --exposure 1");
    command->callback([command, options] {
        finishRenderOptions(*command, *options);
        runRender(*options);
    });
}

}  // namespace phat
