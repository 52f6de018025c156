// The methods of `phat render` that OpenGL draws from a bake.

#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "cli/render_camera.h"
#include "cli/render_files.h"
#include "cli/render_methods.h"
#include "cli/shader_folder.h"
#include "gl/gl_context.h"

namespace phat {
namespace {

using nlohmann::json;

Method methodOf(const RenderOptions& options) {
    return std::string_view(options.method.name) == "phat-pyramid" ? Method::phatPyramid : Method::phat;
}

}  // namespace

std::vector<json> renderDrawn(const RenderOptions& options, Progress& progress) {
    const BakedScene baked = loadBaked(options, progress);
    const Scene& scene = baked.loaded.scene;
    const std::vector<View> views = chooseViews(options, scene);

    const HeadlessContext context;
    Renderer renderer({scene, baked.atlas, baked.points, baked.phatexture}, shaderFolder());
    std::vector<json> reports;
    for (const View& view : views) {
        progress.throwIfStopped();
        const Image picture = renderer.render({.width = view.width,
                                               .height = view.height,
                                               .camera = view.camera,
                                               .method = methodOf(options),
                                               .component = options.component,
                                               .samplesPerPixel = options.samplesPerPixel});
        progress.throwIfStopped();
        writePicture(options, view, picture);
        const FrameTimes times = renderer.lastFrameTimes();
        reports.push_back({{"output", pathFor(view, options.output)},
                           {"method", options.method.name},
                           {"width", view.width},
                           {"height", view.height},
                           {"samplesPerPixel", options.samplesPerPixel},
                           {"gpu", context.rendererName()},
                           {"seconds",
                            {{"relight", times.relight},
                             {"pyramid", times.pyramid},
                             {"shadows", times.shadows},
                             {"display", times.display}}}});
    }
    return reports;
}

}  // namespace phat
