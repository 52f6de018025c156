#include "cli/render_camera.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <glm/gtc/matrix_transform.hpp>
#include <set>

#include "cli/size_option.h"
#include "core/scene/default_camera.h"

namespace phat {
namespace {

constexpr float kDefaultAspect = 16.0f / 9;

const Camera& cameraNamed(const std::string& wanted, const std::vector<Camera>& cameras) {
    std::vector<std::string> names;
    for (const Camera& camera : cameras) {
        if (camera.name == wanted) return camera;
        names.push_back(camera.name);
    }
    char* end = nullptr;
    const unsigned long index = std::strtoul(wanted.c_str(), &end, 10);
    if (end != wanted.c_str() && *end == 0 && index < cameras.size()) return cameras[index];
    throw CLI::ValidationError(
        "--camera", fmt::format("there is no camera \"{}\"; there are: {}", wanted, fmt::join(names, ", ")));
}

Camera placed(Camera camera, const RenderOptions& options, const Scene& scene) {
    if (options.fovDegrees) {
        camera.perspective = true;
        camera.yfovRadians = glm::radians(*options.fovDegrees);
    }
    if (!options.eye && !options.target) return camera;

    const glm::vec3 eye = options.eye.value_or(glm::vec3(camera.worldFromCamera[3]));
    const glm::vec3 target = options.target.value_or(boundsOf(scene).center());
    const glm::vec3 forward = target - eye;
    if (!(glm::length(forward) > 0)) throw CLI::ValidationError("--target", "is where the eye is");
    const bool vertical = glm::length(glm::cross(glm::normalize(forward), glm::vec3(0, 1, 0))) < 1e-3f;
    camera.worldFromCamera =
        glm::inverse(glm::lookAt(eye, target, vertical ? glm::vec3(0, 0, -1) : glm::vec3(0, 1, 0)));
    camera.aspect = 0;
    return camera;
}

View viewOf(const Camera& camera, const RenderOptions& options) {
    const float aspect = camera.aspect > 0 ? camera.aspect : kDefaultAspect;
    const int height = std::clamp(int(std::lround(float(options.width) / aspect)), 1, kMaxPictureSide);
    return {camera, options.width, options.height > 0 ? options.height : height, ""};
}

// Names come from files: what could leave the folder or trouble a shell is replaced.
std::string fileNameOf(const std::string& name) {
    std::string safe = name;
    for (char& c : safe)
        if (!std::isalnum(uint8_t(c)) && c != '-' && c != '_') c = '_';
    return safe;
}

}  // namespace

std::vector<View> chooseViews(const RenderOptions& options, const Scene& scene) {
    if (options.camera != kAllCameras) {
        Camera camera = scene.cameras.empty() ? defaultCamera(scene) : scene.cameras.front();
        if (!options.camera.empty()) camera = cameraNamed(options.camera, scene.cameras);
        return {viewOf(placed(camera, options, scene), options)};
    }
    if (scene.cameras.empty()) throw CLI::ValidationError("--camera", "the file has no cameras");
    std::vector<View> views;
    std::set<std::string> taken;
    for (size_t i = 0; i < scene.cameras.size(); ++i) {
        View view = viewOf(placed(scene.cameras[i], options, scene), options);
        view.label = fileNameOf(scene.cameras[i].name);
        while (view.label.empty() || !taken.insert(view.label).second) view.label += std::to_string(i);
        views.push_back(view);
    }
    return views;
}

FrameSettings frameOf(const RenderOptions& options, const View& view) {
    FrameSettings frame;
    frame.width = view.width;
    frame.height = view.height;
    frame.camera = view.camera;
    frame.quality = options.quality;
    frame.component = options.component;
    frame.samplesPerPixel = options.samplesPerPixel;
    frame.filter = options.filter;
    return frame;
}

std::string pathFor(const View& view, const std::string& path) {
    if (view.label.empty() || path.empty()) return path;
    const std::filesystem::path whole(path);
    std::filesystem::path renamed = whole.parent_path() / whole.stem();
    renamed += "." + view.label + whole.extension().string();
    return renamed.string();
}

}  // namespace phat
