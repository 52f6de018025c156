#pragma once
// What may change after a bake.

#include <vector>

#include "core/scene.h"

namespace phat {

/// Everything that can be edited without a new bake.
struct SceneEdits {
    std::vector<Material> materials;
    std::vector<PunctualLight> lights;
    int environmentColumns = 0;  // by which the sky is turned, see turned() in environment_sampling.h
};

/// A scene as it was read.
SceneEdits noEdits(const Scene& scene);

/// pre: `scene` is as it was read, and the edits are of it.
void applyEdits(const SceneEdits& edits, Scene& scene);

}  // namespace phat
