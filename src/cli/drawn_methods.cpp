// The methods of `phat render` that OpenGL draws from a bake.

#include <fmt/format.h>

#include <optional>

#include "cli/console.h"
#include "cli/data_folders.h"
#include "cli/drawn_report.h"
#include "cli/exposure.h"
#include "cli/render_camera.h"
#include "cli/render_files.h"
#include "cli/render_methods.h"
#include "gl/gl_context.h"
#include "gl/traced_frame.h"
#include "io/base/printable.h"
#include "io/phat/added_things.h"

namespace phat {
namespace {

using nlohmann::json;

Method methodOf(const RenderOptions& options) {
    const std::string_view name = options.method.name;
    if (name == "phat-pyramid") return Method::phatPyramid;
    return name == "phat-paper" ? Method::phatPaper : Method::phat;
}

// pre: a context is current.
bool tracesOnGpu(const RenderOptions& options) {
    if (options.tracer != Tracer::automatic) return options.tracer == Tracer::gpu;
    return prefersGpuRays();
}

// What traced reflections read.
struct RayTracing {
    RayTracing(const BakedScene& baked, Reflections reflections, Progress& progress)
        : rays(baked.loaded.scene),
          lights(baked.loaded.scene),
          scene(rays, lights, baked.atlas, baked.points, baked.phatexture),
          traced{scene, reflections, progress} {}
    const RayScene rays;
    const LightSampler lights;
    const ReflectionScene scene;
    const TracedReflections traced;
};

/// Things that are drawn beside the bake, and the light on them.
struct Things {
    LoadedThings loaded;
    std::optional<AddedThings> added;

    Things(const RenderOptions& options, SceneFile& file, Progress& progress) {
        if (options.things.empty()) return;
        loaded = loadThings(options.things);
        BakedScene& baked = file.baked;
        if (completeProbes(baked, RayScene(baked.loaded.scene), progress))
            loaded.notes.push_back(options.input + " has no light probes; they were made for this picture");
        if (!options.quiet)
            for (const std::string& note : loaded.notes) tell(fmt::format("{}\n", printable(note)));
        added.emplace(AddedThings{loaded.scene, baked.probes});
    }
    const AddedThings* get() const { return added ? &*added : nullptr; }
};

}  // namespace

std::vector<json> renderDrawn(const RenderOptions& options, Progress& progress) {
    SceneFile file = loadBaked(options, progress);
    return renderRead(options, file, progress);
}

std::vector<json> renderRead(const RenderOptions& options, SceneFile& file, Progress& progress) {
    BakedScene& baked = file.baked;
    const Scene& scene = baked.loaded.scene;
    const std::vector<View> views = chooseViews(options, scene);

    const Things things(options, file, progress);
    const HeadlessContext context;
    const Method method = methodOf(options);
    std::optional<RayTracing> tracing;
    const SceneBvh* bvh = nullptr;
    if (method == Method::phat && options.reflections != Reflections::lookup) {
        if (tracesOnGpu(options)) bvh = bvhOf(scene, baked.bvh);
        if (!bvh) tracing.emplace(baked, options.reflections, progress);
    }
    Renderer renderer({scene, baked.atlas, baked.points, baked.phatexture, bvh, things.get()},
                      shaderFolder());
    std::vector<json> reports;
    for (const View& view : views) {
        progress.throwIfStopped();
        FrameSettings frame = frameOf(options, view);
        frame.method = method;
        if (bvh) frame.tracedByGpu = options.reflections;
        frame.followsLast = options.follow;
        if (options.follow) frame.seed = uint32_t(reports.size());
        if (options.countReads) frame.inspection = {Inspected::reads};
        PictureSum sum;
        const ReflectionCost cost = drawFrame(renderer, frame, tracing ? &tracing->traced : nullptr, sum);
        const Image picture = readMean(sum);
        progress.throwIfStopped();
        const Exposure exposure =
            exposureOf(options, view, picture, tracing ? tracing->rays : RayScene(scene));
        writePicture(options, view, picture, exposure.stops);
        reports.push_back(
            drawnReport(options, view, renderer.lastFrameTimes(), cost, context.rendererName()));
        json& report = reports.back();
        if (bvh) report["reflectionRays"] = renderer.lastFrameRays();
        reportExposure(options, exposure, report);
        reportNotes(file, report);
        if (renderer.bytesPerPhatexel() > 0) report["bytesPerPhatexel"] = renderer.bytesPerPhatexel();
        if (options.countReads) report["reads"] = readsReport({&picture, 1});
    }
    return reports;
}

}  // namespace phat
