#include "io/phat/scene_file.h"

#include "io/base/file_error.h"
#include "io/gltf/gltf_source.h"

namespace phat {

BakedScene readSceneFile(const std::string& path, const std::string& environmentPath) {
    GltfSource source = openGltf(path);
    return readSceneFile(source, environmentPath);
}

BakedScene readSceneFile(GltfSource& source, const std::string& environmentPath,
                         const GltfLoadOptions& options) {
    const std::string& path = source.path;
    if (isBakedFile(source)) {
        if (!environmentPath.empty())
            throw FileError(path, "has the environment that it was baked in; bake it again to change that");
        return readBakedFile(source);
    }
    BakedScene plain;
    plain.loaded = loadGltf(source, options);
    if (!environmentPath.empty()) plain.loaded.scene.environment = loadEnvironment(environmentPath);
    if (plain.loaded.scene.triangles.empty()) throw FileError(path, "has no triangles to bake");
    return plain;
}

}  // namespace phat
