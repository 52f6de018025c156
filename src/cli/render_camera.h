#pragma once
// From `phat render`'s flags to views, and the names of their pictures.

#include <string>
#include <vector>

#include "cli/render_options.h"
#include "core/scene/scene.h"
#include "gl/renderer.h"

namespace phat {

inline constexpr const char* kAllCameras = "all";

/// One picture to make.
struct View {
    Camera camera;
    int width = 0;
    int height = 0;
    std::string label;  // goes into file names; empty when it is the only one
};

/// The views that the options select. Throws CLI::ValidationError for cameras that do not exist.
std::vector<View> chooseViews(const RenderOptions& options, const Scene& scene);

/// Settings of all drawn methods, from the options.
FrameSettings frameOf(const RenderOptions& options, const View& view);

/// `path` with the view's label before its extension.
std::string pathFor(const View& view, const std::string& path);

}  // namespace phat
