#include "cli/traced_scene.h"

#include <string_view>

#include "cli/render_files.h"
#include "core/base/stopwatch.h"
#include "core/render/path_tracer.h"
#include "core/transport/path_guide.h"

namespace phat {
namespace {

SceneFile load(const RenderOptions& options, Progress& progress) {
    return options.method.needsBake ? loadBaked(options, progress) : loadScene(options);
}

Scene makeViewedScene(const RenderOptions& options, const Scene& scene) {
    if (!options.keepLight) return {};
    Scene viewedScene = scene;
    editScene(options, viewedScene);
    return viewedScene;
}

PhotonMap photonsFor(const TracedScene& traced, const RenderOptions& options, Progress& progress) {
    if (!options.method.readsPhotons) return {};
    const PhotonSettings settings{.count = options.photons, .seed = options.seed};
    return tracePhotons(traced.rays, traced.lights, settings, progress);
}

PathGuide guideFor(TracedScene& traced, const RenderOptions& options, Progress& progress) {
    if (std::string_view(options.method.name) != "path" || options.component == Component::direct) return {};
    // What a core or two trace in a second; the height where the camera decides it is about this.
    constexpr double kPathsPerSecond = 500'000, kHeightPerWidth = 9.0 / 16;
    const double height = options.height > 0 ? options.height : kHeightPerWidth * options.width;
    const double paths = options.seconds > 0 ? options.seconds * kPathsPerSecond
                                             : options.width * height * options.samplesPerPixel;
    const Stopwatch start;
    PathGuide guide = learnGuide(traced.rays, traced.lights, paths, options.seed, progress);
    traced.guideSeconds = start.seconds();
    return guide;
}

Integrator integratorFor(const TracedScene& traced, const RenderOptions& options) {
    const std::string_view name = options.method.name;
    if (name == "phat-gather") {
        PhatGatherSettings settings = options.gather;
        settings.component = options.component;
        return phatGather(
            {traced.rays, traced.lights, traced.baked.atlas, traced.baked.points, traced.baked.phatexture},
            settings);
    }
    if (options.method.readsPhotons) {
        PhotonRendererSettings settings = options.photonRenderer;
        settings.component = options.component;
        const PhotonScene scene{traced.rays, traced.lights, traced.photons, traced.index,
                                options.keepLight ? &traced.viewedScene : nullptr};
        return name == "photons-direct" ? photonsDirect(scene, settings) : photonsGather(scene, settings);
    }
    return pathTracer(traced.rays, traced.lights, options.component,
                      options.keepLight ? traced.viewedScene : traced.scene, &traced.guide);
}

}  // namespace

TracedScene::TracedScene(const RenderOptions& options, Progress& progress)
    : file(load(options, progress)),
      baked(file.baked),
      scene(baked.loaded.scene),
      viewedScene(makeViewedScene(options, scene)),
      rays(raysOf(scene, file.added)),
      lights(scene),
      photons(photonsFor(*this, options, progress)),
      index(photons.photons),
      guide(guideFor(*this, options, progress)) {
    integrator = integratorFor(*this, options);
}

}  // namespace phat
