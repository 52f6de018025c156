#include "core/scene_edits.h"

#include "core/environment_sampling.h"

namespace phat {

SceneEdits noEdits(const Scene& scene) {
    return {scene.materials, scene.lights, 0};
}

void applyEdits(const SceneEdits& edits, Scene& scene) {
    scene.materials = edits.materials;
    scene.lights = edits.lights;
    if (scene.environment && edits.environmentColumns != 0)
        scene.environment = turned(*scene.environment, edits.environmentColumns);
}

}  // namespace phat
