#pragma once
// Input and output files of `phat render`.

#include "cli/render_camera.h"
#include "cli/render_options.h"
#include "core/base/progress.h"
#include "core/scene/scene.h"
#include "io/phat/baked_file.h"

namespace phat {

/// The scene of a plain or a baked file, with the options' environment and, but for --keep-light, edits.
/// Throws FileError, and CLI::ValidationError for wrong edits.
Scene loadScene(const RenderOptions& options);

/// The same with its bake. A scene that is not baked yet is baked as `phat bake` would without flags.
BakedScene loadBaked(const RenderOptions& options, Progress& progress);

/// Applies --set. Throws CLI::ValidationError.
void editScene(const RenderOptions& options, Scene& scene);

/// Throws, before anything is computed, for outputs of an unknown kind (CLI::ValidationError) or where
/// nothing can be written (FileError).
void checkPlaces(const RenderOptions& options);

/// Writes one view's picture in the format of its file name. Throws FileError.
void writePicture(const RenderOptions& options, const View& view, const Image& picture);

}  // namespace phat
