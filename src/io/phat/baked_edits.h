#pragma once
// Writes edits made after the bake back into its file.

#include <string>

#include "core/scene/scene_edits.h"

namespace phat {

/// Writes the baked file `path`, which holds `from`, to `outPath` (they may be the same) with the materials'
/// factors, the lights' intensities and the sky of `to` where they differ. PHATexels, textures and everything
/// else stay as they are. Throws FileError; an old file at `outPath` then stays as it was.
void writeEdits(const std::string& path, const std::string& outPath, const SceneEdits& from,
                const SceneEdits& to);

}  // namespace phat
