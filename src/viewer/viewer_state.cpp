#include "viewer/viewer_state.h"

#include "core/render/auto_exposure.h"
#include "core/render/path_tracer.h"
#include "core/scene/default_camera.h"

namespace phat {

void showCamera(ViewerState& state, int index) {
    const Scene& scene = state.document->scene();
    const Camera camera = scene.cameras.empty() ? defaultCamera(scene) : scene.cameras[size_t(index)];
    // What is in the middle of the view is orbited.
    uint64_t rays = 0;
    const RayScene& seen = state.document->rays();
    const Hit hit = visibleHit(seen, cameraRay(camera, 2, 2, {1, 1}), rays);
    state.navigation =
        navigationOf(camera, hit ? hit.distance : 0.5f * boundsOf(scene).diagonal(), seen.unitMeters());
    state.camera = index;
    state.touch();
}

void meterExposure(ViewerState& state) {
    // A small picture by the path tracer, which there is before the bake: a third of a second on two cores.
    constexpr int kSamples = 8;
    const Document& document = *state.document;
    PictureSettings settings;
    settings.width = 96;
    settings.height = 64;
    settings.camera = state.navigation.camera;
    settings.samplesPerPixel = kSamples;
    const LightSampler lights(document.shown());
    SilentProgress progress;
    const TracedPicture picture =
        tracePicture(settings, pathTracer(document.rays(), lights, Component::all), progress);
    state.view.exposureStops = autoExposureStops(
        picture.mean, meteredPixels(document.rays(), settings.camera, settings.width, settings.height));
}

void showFirstView(ViewerState& state) {
    showCamera(state, 0);
    meterExposure(state);
}

std::string noticeOf(const Document& document) {
    std::string notice;
    for (const std::string& line : document.added.lines) notice += line + ". ";
    return notice;
}

FrameSettings frameSettings(const ViewerState& state, Source source) {
    FrameSettings settings;
    settings.camera = state.navigation.camera;
    settings.component = state.view.component;
    switch (source) {
        case Source::phat:
        case Source::pathTracer:
            break;
        case Source::phatPyramid:
            settings.method = Method::phatPyramid;
            break;
        case Source::phatPaper:
            settings.method = Method::phatPaper;
            break;
        case Source::direct:
            settings.component = Component::direct;
            break;
        case Source::phatexels:
            settings.inspection = state.view.inspection;
            break;
    }
    return settings;
}

}  // namespace phat
