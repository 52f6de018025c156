#include "core/scene/scene_edits.h"

#include "core/scene/environment_sampling.h"

namespace phat {

SceneEdits noEdits(const Scene& scene) {
    return {scene.materials, scene.lights, 0, {}};
}

void applyEdits(const SceneEdits& from, const SceneEdits& to, Scene& scene) {
    scene.materials = to.materials;
    scene.lights = to.lights;
    if (scene.environment && from.environmentColumns != to.environmentColumns)
        scene.environment = turned(*scene.environment, to.environmentColumns - from.environmentColumns);
}

}  // namespace phat
