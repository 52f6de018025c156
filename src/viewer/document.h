#pragma once
// An open file.

#include <filesystem>
#include <string>

#include "core/rays.h"
#include "io/baked_file.h"
#include "viewer/edit_history.h"

namespace phat {

struct Document {
    /// A baked file, or a scene without its bake. `environmentPath` empty: the file's own sky. Throws
    /// FileError.
    Document(const std::string& path, const std::string& environmentPath);
    Document(const Document&) = delete;
    Document& operator=(const Document&) = delete;

    const Scene& scene() const { return baked.loaded.scene; }

    std::string path;
    BakedScene baked;
    bool hasBake = false;
    RayScene rays;  // for picking
    EditHistory edits;
    std::filesystem::file_time_type writeTime;  // of the file as it was read
};

}  // namespace phat
