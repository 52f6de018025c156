#include "viewer/things_beside.h"

namespace phat {

const AddedThings* ThingsBeside::in(Document& document) {
    if (loaded_.scene.triangles.empty()) return nullptr;
    SilentProgress progress;
    completeProbes(document.baked, RayScene(document.scene()), progress);
    added_.emplace(AddedThings{loaded_.scene, document.baked.probes});
    return &*added_;
}

}  // namespace phat
