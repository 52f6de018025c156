#include "io/phat/scene_file.h"

#include "io/base/file_error.h"
#include "io/gltf/blender_units.h"
#include "io/gltf/gltf_source.h"

namespace phat {

SceneFile readSceneFile(const std::string& path, const SceneLighting& lighting,
                        const GltfLoadOptions& options) {
    GltfSource source = openGltf(path);
    return readSceneFile(source, lighting, BakedLighting::refuse, options);
}

SceneFile readSceneFile(GltfSource& source, const SceneLighting& lighting, BakedLighting whenBaked,
                        const GltfLoadOptions& options) {
    SceneFile file;
    std::optional<std::string> units;
    if (isBakedFile(source)) {
        if (!lighting.photometries.empty())
            throw FileError(source.path,
                            "is baked with the photometry that it has; give another to the scene");
        if (lighting.asked() && whenBaked == BakedLighting::refuse)
            throw FileError(source.path, "has the light that it was baked in; bake it again to change that");
        if (lighting.asked()) removeAddedLights(source.json);
        file.baked = readBakedFile(source);
        if (!lighting.asked()) return file;
        file.baked.loaded.scene.environment = {};
    } else {
        GltfLoadOptions withLights = options;
        withLights.photometries = lighting.photometries;
        file.baked.loaded = loadGltf(source, withLights);
        units = blenderUnitsNote(source, file.baked.loaded.scene);
    }
    if (whenBaked == BakedLighting::refuse && file.baked.loaded.scene.triangles.empty())
        throw FileError(source.path, "has no triangles to bake");
    file.added = addLighting(lighting, file.baked.loaded.scene);
    if (units) file.added.lines.push_back(std::move(*units));
    for (const std::string& line : file.added.lines) file.baked.loaded.notes.push_back(line);
    return file;
}

}  // namespace phat
