#include "core/scene/scene.h"

namespace phat {

Bounds boundsOf(const Scene& scene) {
    Bounds bounds;
    for (const glm::uvec3& t : scene.triangles)
        for (int corner = 0; corner < 3; ++corner) bounds.add(scene.positions[t[corner]]);
    return bounds;
}

}  // namespace phat
