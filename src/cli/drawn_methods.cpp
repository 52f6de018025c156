// The methods of `phat render` that OpenGL draws from a bake.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>

#include "cli/render_camera.h"
#include "cli/render_files.h"
#include "cli/render_methods.h"
#include "gl/gl_context.h"

namespace phat {
namespace {

using nlohmann::json;

std::filesystem::path shaderFolder() {
    // Installed beside the program, or where it was built.
    std::error_code ignored;
    const auto program = std::filesystem::read_symlink("/proc/self/exe", ignored);
    const auto installed = program.parent_path().parent_path() / "share/phatextures/shaders";
    return std::filesystem::is_directory(installed, ignored) ? installed
                                                             : std::filesystem::path(PHAT_SHADER_DIR);
}

Method methodOf(const RenderOptions& options) {
    return std::string_view(options.method.name) == "phat-pyramid" ? Method::phatPyramid : Method::phat;
}

}  // namespace

std::vector<json> renderDrawn(const RenderOptions& options, Progress& progress) {
    const BakedScene baked = loadBaked(options, progress);
    const Scene& scene = baked.loaded.scene;
    const std::vector<View> views = chooseViews(options, scene);

    const HeadlessContext context;
    Renderer renderer({scene, baked.atlas, baked.points, baked.phatexture}, shaderFolder().string());
    const RayScene rays(scene);
    const LightSampler lights(scene);
    const ReflectionScene reflectionScene(rays, lights, baked.atlas, baked.points, baked.phatexture);
    const TracedReflections traced{reflectionScene, options.reflections, progress};
    std::vector<json> reports;
    for (const View& view : views) {
        progress.throwIfStopped();
        const Image picture = renderer.render({.width = view.width,
                                               .height = view.height,
                                               .camera = view.camera,
                                               .method = methodOf(options),
                                               .component = options.component,
                                               .samplesPerPixel = options.samplesPerPixel,
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
    }
    return reports;
}

}  // namespace phat
