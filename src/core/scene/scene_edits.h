#pragma once
// Edits of a scene after its bake.

#include <vector>

#include "core/scene/scene_motion.h"

namespace phat {

/// Everything that can be edited without a new bake. Lights are where they are at rest.
struct SceneEdits {
    std::vector<Material> materials;
    std::vector<PunctualLight> lights;
    int environmentColumns =
        0;  // by which the environment is rotated, see turned() in environment_sampling.h
    std::vector<NodeMotion> motions;  // one a node at most
};

/// A scene as it was read.
SceneEdits noEdits(const Scene& scene);

}  // namespace phat
