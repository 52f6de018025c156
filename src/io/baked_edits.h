#pragma once
// Materials and lights that were changed after the bake, back into its file.

#include <string>
#include <vector>

#include "core/scene.h"

namespace phat {

/// Writes the baked file `path` to `outPath` (they may be the same) with the factors of `materials` and the
/// intensities of `lights` where they differ from `scene`, which was read from `path`. PHATexels, textures
/// and everything else stay as they are. Throws FileError; an old file at `outPath` then stays as it was.
void writeEdits(const std::string& path, const std::string& outPath, const Scene& scene,
                const std::vector<Material>& materials, const std::vector<PunctualLight>& lights);

}  // namespace phat
