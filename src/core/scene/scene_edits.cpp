#include "core/scene/scene_edits.h"

namespace phat {

SceneEdits noEdits(const Scene& scene) {
    return {scene.materials, scene.lights, 0, {}};
}

}  // namespace phat
