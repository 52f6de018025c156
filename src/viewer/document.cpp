#include "viewer/document.h"

#include <fmt/format.h>

#include <filesystem>

#include "io/file_error.h"
#include "io/gltf_loader.h"
#include "io/material_edit.h"

namespace phat {
namespace {

BakedScene load(const std::string& path, const std::string& environment) {
    if (isBakedFile(path)) {
        if (!environment.empty())
            throw FileError(path, "has the environment that it was baked in; bake it again to change that");
        return readBakedFile(path);
    }
    BakedScene plain;
    plain.loaded = loadGltf(path);
    if (!environment.empty()) plain.loaded.scene.environment = loadEnvironment(environment);
    if (plain.loaded.scene.triangles.empty()) throw FileError(path, "has no triangles to bake");
    return plain;
}

}  // namespace

Document::Document(const std::string& file, const std::string& environmentPath)
    : path(file),
      baked(load(file, environmentPath)),
      hasBake(!baked.phatexture.indirect.empty()),
      rays(scene()),
      edits({scene().materials, scene().lights}),
      writeTime(std::filesystem::last_write_time(file)) {}

}  // namespace phat
