// The methods of `phat render` that trace rays on the CPU.

#include <chrono>

#include "cli/render_camera.h"
#include "cli/render_files.h"
#include "cli/render_methods.h"
#include "cli/traced_scene.h"
#include "io/image_file.h"

namespace phat {

using nlohmann::json;

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
        const auto start = std::chrono::steady_clock::now();
        const TracedPicture picture = tracePicture(settings, traced.integrator, progress);
        const double seconds =
            std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();

        progress.throwIfStopped();
        writePicture(options, view, picture.mean);
        if (!options.varianceOutput.empty())
            writeExr(pathFor(view, options.varianceOutput), picture.variance);
        reports.push_back({{"output", pathFor(view, options.output)},
                           {"method", options.method.name},
                           {"width", view.width},
                           {"height", view.height},
                           {"samplesPerPixel", picture.samplesPerPixel},
                           {"seconds", seconds},
                           {"raysPerSecond", double(picture.rays) / std::max(seconds, 1e-9)}});
    }
    return reports;
}

}  // namespace phat
