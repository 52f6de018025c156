// Frames of an animated scene under dynamic lighting.

#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "cli/data_folders.h"
#include "cli/drawn_report.h"
#include "cli/exposure.h"
#include "cli/render_camera.h"
#include "cli/render_files.h"
#include "cli/render_methods.h"
#include "core/base/stopwatch.h"
#include "core/dynamic/incremental_baker.h"
#include "gl/gl_context.h"
#include "gl/traced_frame.h"
#include "io/phat/bake_record.h"

namespace phat {
namespace {

using nlohmann::json;

// Rays between two looks at the clock: some milliseconds.
constexpr uint64_t kWorkAtOnce = 20'000;

/// Lets the light follow for a frame; returns the work that was done.
uint64_t follow(IncrementalBaker& engine, const AnimatedFrames& frames, Progress& progress) {
    if (frames.secondsPerFrame <= 0) return engine.advance(uint64_t(frames.workPerFrame), progress);
    const Stopwatch start;
    uint64_t work = 0;
    while (start.seconds() < frames.secondsPerFrame) {
        if (engine.converged()) break;
        work += engine.advance(kWorkAtOnce, progress);
    }
    return work;
}

View frameView(View view, int frame) {
    view.label += fmt::format("{}{:04}", view.label.empty() ? "" : ".", frame);
    return view;
}

/// What a frame takes before it is drawn.
struct FrameCost {
    double move = 0, follow = 0, upload = 0;  // seconds
    uint64_t work = 0;                        // of the engine
};

FrameCost moveTo(const SceneState& state, PosedScene& posed, IncrementalBaker& engine, Renderer& renderer,
                 const AnimatedFrames& frames, Progress& progress) {
    FrameCost cost;
    const DynamicScene& scene = engine.scene();
    cost.move = secondsOf([&] {
        posed.setState(state);
        if (engine.setScene(posed.snapshot()))
            renderer.moveScene(scene.scene(), scene.atlas(), scene.points(), state.worldFromRest);
    });
    cost.follow = secondsOf([&] { cost.work = follow(engine, frames, progress); });
    cost.upload = secondsOf([&] {
        LightUpdate update = engine.drainUpdate();
        renderer.takeUpdate(update, std::numeric_limits<double>::infinity());
    });
    return cost;
}

}  // namespace

std::vector<json> renderAnimated(const RenderOptions& options, Progress& progress) {
    const AnimatedFrames& frames = *options.animated;
    SceneFile file = loadBaked(options, progress);
    BakedScene& baked = file.baked;
    PosedScene posed(std::move(baked.loaded.scene));
    const Scene& rest = posed.rest();
    const Animation& animation = animationOf(options, rest);
    const std::vector<View> views = chooseViews(options, rest);
    const auto poseAt = [&](double seconds) {
        return SceneState{worldFromRest(rest.nodes, animation, seconds), rest.lights, rest.materials};
    };

    IncrementalBaker engine(posed.snapshotAtRest(), baked.atlas, baked.points, baked.phatexture,
                            settingsOf(baked.record));
    engine.setEye(&views.front().camera);
    posed.setState(poseAt(frames.start));
    engine.setScene(posed.snapshot());
    engine.converge(progress);  // the film begins with the right light
    engine.drainUpdate();

    const HeadlessContext context;
    Renderer renderer({engine.scene().scene(), baked.atlas, engine.scene().points(), engine.phatexture()},
                      shaderFolder());
    std::vector<json> reports;
    std::vector<std::optional<Exposure>> exposures(views.size());  // the first frame's: films do not flicker
    // A frame at the very end, whatever rounding makes of it.
    const int count = int(std::floor((frames.end - frames.start) * frames.perSecond + 1e-6)) + 1;
    uint64_t updated = engine.stats().phatexels;
    for (int i = 0; i < count; ++i) {
        progress.throwIfStopped();
        const double seconds = frames.start + double(i) / frames.perSecond;
        const FrameCost cost = moveTo(poseAt(seconds), posed, engine, renderer, frames, progress);
        const ReflectionScene reflectionScene(engine.rays(), engine.lights(), baked.atlas,
                                              engine.scene().points(), engine.phatexture());
        const TracedReflections traced{reflectionScene, options.reflections, progress};
        for (size_t v = 0; v < views.size(); ++v) {
            const View& view = views[v];
            PictureSum sum;
            const ReflectionCost rays = drawFrame(renderer, frameOf(options, view), &traced, sum);
            const Image picture = readMean(sum);
            progress.throwIfStopped();
            const View frame = frameView(view, i);
            if (exposures[v]) exposures[v]->causeOfBlack.clear();  // of the first frame alone
            if (!exposures[v]) exposures[v] = exposureOf(options, view, picture, engine.rays());
            writePicture(options, frame, picture, exposures[v]->stops);
            json report =
                drawnReport(options, frame, renderer.lastFrameTimes(), rays, context.rendererName());
            report["seconds"].update({{"move", cost.move}, {"follow", cost.follow}, {"upload", cost.upload}});
            report.update({{"animationSeconds", seconds},
                           {"work", cost.work},
                           {"phatexels", engine.stats().phatexels - updated},
                           {"settled", engine.converged()}});
            reportExposure(options, *exposures[v], report);
            reportNotes(file, report);
            reports.push_back(std::move(report));
        }
        updated = engine.stats().phatexels;
    }
    return reports;
}

}  // namespace phat
