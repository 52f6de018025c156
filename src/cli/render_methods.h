#pragma once
// The two families of `phat render`'s methods.

#include <nlohmann/json.hpp>
#include <vector>

#include "cli/render_options.h"
#include "core/base/progress.h"

namespace phat {

struct SceneFile;  // io/phat/scene_file.h

/// They draw every view, write the pictures and return what --json prints of each. Nothing is written once
/// `progress` was asked to stop.
std::vector<nlohmann::json> renderDrawn(const RenderOptions& options, Progress& progress);
std::vector<nlohmann::json> renderAnimated(const RenderOptions& options, Progress& progress);
std::vector<nlohmann::json> renderRefined(const RenderOptions& options, Progress& progress);
std::vector<nlohmann::json> renderTraced(const RenderOptions& options, Progress& progress);

/// renderDrawn of a file that is read; its light probes are completed where things need them. pre: it is
/// baked, and the options change nothing of it.
std::vector<nlohmann::json> renderRead(const RenderOptions& options, SceneFile& file, Progress& progress);

}  // namespace phat
