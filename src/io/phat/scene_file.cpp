#include "io/phat/scene_file.h"

#include "io/base/file_error.h"

namespace phat {

BakedScene readSceneFile(const std::string& path, const std::string& environmentPath) {
    if (isBakedFile(path)) {
        if (!environmentPath.empty())
            throw FileError(path, "has the environment that it was baked in; bake it again to change that");
        return readBakedFile(path);
    }
    BakedScene plain;
    plain.loaded = loadGltf(path);
    if (!environmentPath.empty()) plain.loaded.scene.environment = loadEnvironment(environmentPath);
    if (plain.loaded.scene.triangles.empty()) throw FileError(path, "has no triangles to bake");
    return plain;
}

}  // namespace phat
