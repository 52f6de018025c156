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
    const std::string_view name = options.method.name;
    if (name == "phat-pyramid") return Method::phatPyramid;
    return name == "phat-paper" ? Method::phatPaper : Method::phat;
}

// Of pixels that show a surface; a channel a source, see RendererInput::countReads.
json readsOf(const Image& picture, int channel) {
    double sum = 0, most = 0;
    size_t count = 0;
    for (const glm::vec3& pixel : picture.pixels) {
        if (pixel.x <= 0) continue;
        sum += pixel[channel];
        most = std::max(most, double(pixel[channel]));
        ++count;
    }
    return {{"mean", sum / double(std::max<size_t>(count, 1))}, {"max", most}};
}

}  // namespace

std::vector<json> renderDrawn(const RenderOptions& options, Progress& progress) {
    const BakedScene baked = loadBaked(options, progress);
    const Scene& scene = baked.loaded.scene;
    const std::vector<View> views = chooseViews(options, scene);

    const HeadlessContext context;
    const RayScene rays(scene);
    const LightSampler lights(scene);
    const ReflectionScene reflectionScene(rays, lights, baked.atlas, baked.points, baked.phatexture);
    const TracedReflections traced{reflectionScene, options.reflections, progress};
    Renderer renderer({scene, baked.atlas, baked.points, baked.phatexture, options.countReads},
                      shaderFolder());
    std::vector<json> reports;
    for (const View& view : views) {
        progress.throwIfStopped();
        const Image picture = renderer.render({.width = view.width,
                                               .height = view.height,
                                               .camera = view.camera,
                                               .method = methodOf(options),
                                               .quality = options.quality,
                                               .component = options.component,
                                               .samplesPerPixel = options.samplesPerPixel,
                                               .filter = options.filter,
                                               .traced = &traced});
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
                             {"display", times.display},
                             {"reflections", times.reflections}}},
                           {"reflectionRays", times.reflectionRays}});
        json& report = reports.back();
        if (renderer.bytesPerPhatexel() > 0) report["bytesPerPhatexel"] = renderer.bytesPerPhatexel();
        if (options.countReads) report["reads"] = {{"indirect", readsOf(picture, 0)}, {"area", readsOf(picture, 1)}};
    }
    return reports;
}

}  // namespace phat
