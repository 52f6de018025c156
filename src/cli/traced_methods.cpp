// The methods of `phat render` that trace rays on the CPU.

#include <fmt/format.h>

#include "cli/exposure.h"
#include "cli/render_camera.h"
#include "cli/render_files.h"
#include "cli/render_methods.h"
#include "cli/traced_scene.h"
#include "core/base/stopwatch.h"
#include "io/base/file_error.h"
#include "io/image/image_file.h"

namespace phat {

using nlohmann::json;

namespace {

std::vector<uint32_t> pixelsOf(const std::string& path, const View& view) {
    const Image mask = readPicture(path);
    if (mask.width != view.width || mask.height != view.height)
        throw FileError(path, fmt::format("is {} x {} pixels, the picture {} x {}", mask.width, mask.height,
                                          view.width, view.height));
    std::vector<uint32_t> kept;
    for (size_t i = 0; i < mask.pixels.size(); ++i)
        if (mask.pixels[i].x > 0.5f) kept.push_back(uint32_t(i));
    if (kept.empty()) throw FileError(path, "keeps no pixel (none exceeds 0.5)");
    return kept;
}

}  // namespace

std::vector<json> renderTraced(const RenderOptions& options, Progress& progress) {
    const TracedScene traced(options, progress);
    const std::vector<View> views = chooseViews(options, traced.scene);

    std::vector<json> reports;
    for (const View& view : views) {
        PictureSettings settings;
        settings.width = view.width;
        settings.height = view.height;
        settings.camera = view.camera;
        settings.samplesPerPixel = options.samplesPerPixel;
        settings.seconds = options.seconds;
        settings.seed = options.seed;
        settings.filter = options.filter;
        if (!options.pixels.empty()) settings.pixels = pixelsOf(options.pixels, view);
        const Stopwatch start;
        const TracedPicture picture = tracePicture(settings, traced.integrator, progress);
        const double seconds = start.seconds();

        progress.throwIfStopped();
        const Exposure exposure = exposureOf(options, view, picture.mean, traced.rays);
        writePicture(options, view, picture.mean, exposure.stops);
        if (!options.varianceOutput.empty())
            writeExr(pathFor(view, options.varianceOutput), picture.variance);
        reports.push_back({{"output", pathFor(view, options.output)},
                           {"method", options.method.name},
                           {"width", view.width},
                           {"height", view.height},
                           {"samplesPerPixel", picture.samplesPerPixel},
                           {"seconds", seconds},
                           {"guideSeconds", traced.guideSeconds},
                           {"raysPerSecond", double(picture.rays) / std::max(seconds, 1e-9)}});
        reportExposure(options, exposure, reports.back());
        reportNotes(traced.file, reports.back());
    }
    return reports;
}

}  // namespace phat
