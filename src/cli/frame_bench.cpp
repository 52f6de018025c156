#include "cli/frame_bench.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "cli/drawn_report.h"
#include "core/base/median.h"
#include "core/base/stopwatch.h"
#include "gl/picture_sum.h"

namespace phat {
namespace {

using Json = nlohmann::ordered_json;

// twin: web/viewer/bench.js
constexpr int kWarmUpFrames = 4;
constexpr double kSwingDegrees = 20, kSwayUnits = 0.1;
constexpr int kMinPeriod = 16;  // frames
// Reads differ little from view to view.
constexpr int kCountedViews = 4;

// How many periods are over. A third of a frame off, so that no two frames in a row are of one place.
double periodsAt(int frame, int frames) {
    return (frame + 1.0 / 3) / std::max(frames, kMinPeriod);
}

Camera moved(Camera camera, double periods, float unitMeters) {
    const double side = std::sin(2 * double(kPi) * periods);
    const glm::vec4 eye =
        camera.worldFromCamera[3] + float(side * kSwayUnits) * unitMeters * camera.worldFromCamera[0];
    camera.worldFromCamera = glm::rotate(glm::mat4(1), glm::radians(float(side * kSwingDegrees)), {0, 1, 0}) *
                             camera.worldFromCamera;
    camera.worldFromCamera[3] = eye;
    return camera;
}

// Tenths of a microsecond are more than a clock knows.
double milliseconds(const std::vector<double>& seconds) {
    return std::round(medianOf(seconds) * 1e7) * 1e-4;
}

struct Measured {
    std::vector<FrameTimes> gpu;
    std::vector<double> clock;  // seconds
    std::vector<double> rays;
};

Measured measure(Renderer& renderer, FrameSettings frame, const BenchSettings& settings, Progress& progress) {
    const Camera first = frame.camera;
    Measured measured;
    PictureSum sum;
    ProgressStage stage(progress, "measure", uint64_t(kWarmUpFrames + settings.frames));
    for (int i = -kWarmUpFrames; i < settings.frames; ++i) {
        progress.throwIfStopped();
        frame.camera = moved(first, periodsAt(i, settings.frames), settings.unitMeters);
        ++frame.seed;
        const Stopwatch start;
        renderer.draw(frame, sum);
        const FrameTimes times = renderer.lastFrameTimes();  // waits for the GPU
        progress.advance(1);
        if (i < 0) continue;
        measured.clock.push_back(start.seconds());
        measured.gpu.push_back(times);
        measured.rays.push_back(double(renderer.lastFrameRays()));
    }
    return measured;
}

Json passesOf(const std::vector<FrameTimes>& frames) {
    Json passes = Json::object();
    for (const NamedPass& pass : kGpuPasses) {
        std::vector<double> seconds;
        for (const FrameTimes& frame : frames) seconds.push_back(frame.*pass.seconds);
        if (*std::max_element(seconds.begin(), seconds.end()) > 0) passes[pass.name] = milliseconds(seconds);
    }
    return passes;
}

// The mean over some of the views.
Json countedReads(Renderer& renderer, FrameSettings frame, float unitMeters) {
    const Camera first = frame.camera;
    frame.inspection = {Inspected::reads};
    std::vector<Image> pictures;
    for (int i = 0; i < kCountedViews; ++i) {
        frame.camera = moved(first, double(i) / kCountedViews, unitMeters);
        pictures.push_back(renderer.render(frame));
    }
    return readsReport(pictures);
}

double fetchesPerPixel(Renderer& renderer, FrameSettings frame, float unitMeters) {
    const Camera first = frame.camera;
    double sum = 0;
    for (int i = 0; i < kCountedViews; ++i) {
        frame.camera = moved(first, double(i) / kCountedViews, unitMeters);
        sum += double(renderer.countRayFetches(frame));
    }
    return std::round(10 * sum / kCountedViews / double(frame.width) / double(frame.height)) / 10;
}

}  // namespace

Json benchFrames(Renderer& renderer, FrameSettings frame, const BenchSettings& settings, Progress& progress) {
    frame.samplesPerPixel = 1;
    frame.followsLast = true;
    const Measured measured = measure(renderer, frame, settings, progress);
    std::vector<double> gpu;
    for (const FrameTimes& times : measured.gpu) gpu.push_back(times.gpu());
    Json report{{"timer", "gpu"},
                {"passMilliseconds", passesOf(measured.gpu)},
                {"gpuMilliseconds", milliseconds(gpu)},
                {"frameMilliseconds", milliseconds(measured.clock)}};
    if (frame.tracedByGpu != Reflections::lookup) {
        const double rays = medianOf(measured.rays);
        std::vector<double> seconds;
        for (const FrameTimes& times : measured.gpu) seconds.push_back(times.rays());
        report["raysPerPixel"] = std::round(100 * rays / double(frame.width) / double(frame.height)) / 100;
        report["fetchesPerPixel"] = fetchesPerPixel(renderer, frame, settings.unitMeters);
        report["raysPerSecond"] = std::round(rays / std::max(medianOf(seconds), 1e-9));
    }
    if (renderer.bytesPerPhatexel() > 0) report["reads"] = countedReads(renderer, frame, settings.unitMeters);
    return report;
}

}  // namespace phat
