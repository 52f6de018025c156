#include "gl/traced_frame.h"

#include "core/base/stopwatch.h"

namespace phat {

ReflectionCost drawFrame(Renderer& renderer, const FrameSettings& settings, const TracedReflections* traced,
                         PictureSum& sum) {
    ReflectionCost cost;
    renderer.restartTimes();
    for (int left = samplesToDraw(settings, sum); left > 0; --left) {
        const PendingSample sample =
            renderer.beginSample(settings, traced ? traced->reflections : Reflections::lookup, sum);
        std::vector<SurfaceIncident> incident;
        if (!sample.surfaces.empty()) {
            const Stopwatch start;
            incident =
                traceReflections(traced->scene, sample.view, sample.surfaces, traced->progress, cost.rays);
            cost.seconds += start.seconds();
        }
        renderer.finishSample(sample, incident, sum);
    }
    return cost;
}

}  // namespace phat
