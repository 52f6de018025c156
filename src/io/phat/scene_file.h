#pragma once
// Any file that the program opens: a scene, with its bake or without, and its light.

#include "io/phat/baked_file.h"
#include "io/phat/scene_lighting.h"

namespace phat {

/// A file's scene and bake, and what was added to its light or is to be said of it.
struct SceneFile {
    BakedScene baked;  // of a scene without a bake `phatexture.indirect` is empty
    AddedLighting added;
};

/// What a baked file does with lighting that is asked for: the light is part of the bake, but whoever bakes
/// it again or has no use for the bake may have another.
enum class BakedLighting : uint8_t { refuse, replace };

/// Reads a file and lights it. The added lines are among the scene's notes, too. Throws FileError, also for a
/// baked file that is refused other lighting than its own. `options`: of a scene without a bake.
SceneFile readSceneFile(const std::string& path, const SceneLighting& lighting,
                        const GltfLoadOptions& options = {});
/// The same of a file that is open; reads its buffers. pre: they are not read yet.
SceneFile readSceneFile(GltfSource& source, const SceneLighting& lighting,
                        BakedLighting whenBaked = BakedLighting::refuse, const GltfLoadOptions& options = {});

}  // namespace phat
