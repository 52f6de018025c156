// Pictures of a still scene whose light is made anew time and again: what they average converges past one
// bake.

#include "cli/data_folders.h"
#include "cli/drawn_report.h"
#include "cli/exposure.h"
#include "cli/render_camera.h"
#include "cli/render_files.h"
#include "cli/render_methods.h"
#include "core/dynamic/incremental_baker.h"
#include "gl/gl_context.h"
#include "gl/traced_frame.h"
#include "io/phat/bake_record.h"

namespace phat {

using nlohmann::json;

std::vector<json> renderRefined(const RenderOptions& options, Progress& progress) {
    SceneFile file = loadBaked(options, progress);
    BakedScene& baked = file.baked;
    const PosedScene posed(std::move(baked.loaded.scene));
    const Scene& scene = posed.rest();
    const std::vector<View> views = chooseViews(options, scene);

    const HeadlessContext context;
    IncrementalBaker engine(posed.snapshotAtRest(), baked.atlas, baked.points, baked.phatexture,
                            settingsOf(baked.record));
    Renderer renderer({scene, baked.atlas, baked.points, engine.phatexture()}, shaderFolder());
    std::vector<PictureSum> sums(views.size());
    std::vector<json> reports;
    uint64_t work = 0;
    for (int pass = 0; pass <= options.refinements; ++pass) {
        if (pass > 0) engine.refine();
        work += engine.converge(progress);
        LightUpdate update = engine.drainUpdate();
        renderer.takeUpdate(update, std::numeric_limits<double>::infinity());
        const ReflectionScene reflectionScene(engine.rays(), engine.lights(), baked.atlas,
                                              engine.scene().points(), engine.phatexture());
        const TracedReflections traced{reflectionScene, options.reflections, progress};
        for (size_t v = 0; v < views.size(); ++v) {
            FrameSettings settings = frameOf(options, views[v]);
            settings.samplesPerPixel *= pass + 1;  // in all
            const ReflectionCost cost = drawFrame(renderer, settings, &traced, sums[v]);
            progress.throwIfStopped();
            if (pass < options.refinements) continue;
            const Image picture = readMean(sums[v]);
            const Exposure exposure = exposureOf(options, views[v], picture, engine.rays());
            writePicture(options, views[v], picture, exposure.stops);
            reports.push_back(
                drawnReport(options, views[v], renderer.lastFrameTimes(), cost, context.rendererName()));
            reports.back().update({{"refinements", options.refinements}, {"work", work}});
            reportExposure(options, exposure, reports.back());
            reportNotes(file, reports.back());
        }
    }
    return reports;
}

}  // namespace phat
