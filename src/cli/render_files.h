#pragma once
// Input and output files of `phat render`.

#include <nlohmann/json_fwd.hpp>

#include "cli/render_camera.h"
#include "cli/render_options.h"
#include "core/base/progress.h"
#include "core/scene/scene.h"
#include "io/phat/scene_file.h"

namespace phat {

/// The scene of a plain or a baked file, with the options' light and, but for --keep-light, edits. Says on
/// stderr what light was added. Throws FileError, and CLI::ValidationError for views and edits that the scene
/// does not have.
SceneFile loadScene(const RenderOptions& options);

/// The same with its bake. A scene that is not baked yet is baked as `phat bake` would without flags, once
/// all that can be wrong has been checked.
SceneFile loadBaked(const RenderOptions& options, Progress& progress);

/// The animation that the options select. Throws CLI::ValidationError. pre: options.animated.
const Animation& animationOf(const RenderOptions& options, const Scene& scene);

/// Adds to a view's report what light was added, if any.
void reportNotes(const SceneFile& file, nlohmann::json& report);

/// Applies --set. Throws CLI::ValidationError.
void editScene(const RenderOptions& options, Scene& scene);

/// Throws, before anything is computed, for outputs of an unknown kind (CLI::ValidationError) or where
/// nothing can be written (FileError).
void checkPlaces(const RenderOptions& options);

/// Whether a picture's format keeps linear radiance.
bool isLinear(const std::string& path);

/// Writes one view's picture in the format of its file name. Throws FileError.
void writePicture(const RenderOptions& options, const View& view, const Image& picture, float exposureStops);

}  // namespace phat
