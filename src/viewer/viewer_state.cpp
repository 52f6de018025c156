#include "viewer/viewer_state.h"

namespace phat {

void showCamera(ViewerState& state, int index) {
    const Scene& scene = state.document->scene();
    const Camera camera = scene.cameras.empty() ? defaultCamera(scene) : scene.cameras[size_t(index)];
    // What is in the middle of the view is orbited.
    uint64_t rays = 0;
    const Hit hit = visibleHit(state.document->rays(), cameraRay(camera, 2, 2, {1, 1}), rays);
    state.navigation = navigationOf(camera, hit ? hit.distance : 0.5f * boundsOf(scene).diagonal());
    state.camera = index;
    state.touch();
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
