#pragma once
// Any file that the program opens: a scene, with its bake or without.

#include "io/phat/baked_file.h"

namespace phat {

/// A baked file, or a scene without a bake (`phatexture.indirect` is empty) under the sky `environmentPath`
/// (empty: the file's own). Throws FileError, also for a scene without triangles and for a baked file with
/// another sky than its own.
BakedScene readSceneFile(const std::string& path, const std::string& environmentPath);
/// The same of a file that is open; reads its buffers. `options`: of a scene without a bake. pre: they
/// are not read yet.
BakedScene readSceneFile(GltfSource& source, const std::string& environmentPath,
                         const GltfLoadOptions& options = {});

}  // namespace phat
