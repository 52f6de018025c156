#include "gl/traced_frame.h"

#include <algorithm>

#include "core/base/stopwatch.h"
#include "gl/gl_context.h"

namespace phat {

bool prefersGpuRays() {
    return !drawsInSoftware();
}

ReflectionCost drawFrame(Renderer& renderer, const FrameSettings& settings, const TracedReflections* traced,
                         PictureSum& sum) {
    ReflectionCost cost;
    renderer.restartTimes();
    for (int left = samplesToDraw(settings, sum); left > 0; --left) {
        const PendingSample sample =
            renderer.beginSample(settings, traced ? traced->reflections : Reflections::lookup, sum);
        const auto trace = [&](const std::vector<TracedSurface>& surfaces) {
            std::vector<SurfaceIncident> incident;
            if (surfaces.empty()) return incident;
            const Stopwatch start;
            incident = traceReflections(traced->scene, sample.view, surfaces, traced->progress, cost.rays);
            cost.seconds += start.seconds();
            return incident;
        };
        const TracedIncident incident{trace(sample.surfaces), trace(sample.panes)};
        renderer.finishSample(sample, incident, sum);
        if (sum.preview) break;
    }
    return cost;
}

}  // namespace phat
