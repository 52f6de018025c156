#include "io/phat/added_things.h"

#include <algorithm>

#include "core/probes/bake_probes.h"
#include "core/scene/join_scenes.h"
#include "core/scene/transparency.h"

namespace phat {

LoadedThings loadThings(const std::vector<std::string>& paths) {
    LoadedThings things;
    for (const std::string& path : paths) {
        const LoadedScene loaded = loadGltf(path);
        if (loaded.scene.triangles.empty()) throw FileError(path, "has no triangles");
        for (const std::string& note : loaded.notes) things.notes.push_back(path + ": " + note);
        if (std::any_of(loaded.scene.materials.begin(), loaded.scene.materials.end(), isGlass))
            things.notes.push_back(path + ": glass is drawn opaque");
        appendSurfaces(things.scene, loaded.scene);
    }
    return things;
}

bool completeProbes(BakedScene& baked, const RayScene& rays, Progress& progress) {
    if (baked.probes.count() > 0) return false;
    std::atomic<uint64_t> rayCount = 0;
    baked.probes = bakeLightProbes({rays, baked.atlas, baked.points, baked.phatexture}, ProbeSettings(),
                                   {progress, nullptr, rayCount});
    return true;
}

}  // namespace phat
