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

    /// As it was read; what a bake in the background works on.
    const Scene& scene() const { return baked.loaded.scene; }
    /// Brings `shown` to the edits of now.
    void showEdits();
    /// Writes the edits into the baked file; a bake that was made here goes beside its scene first. Returns
    /// the file's path. Throws FileError. pre: hasBake.
    std::string save();

    std::string path;
    std::string environmentPath;
    BakedScene baked;
    bool hasBake = false;
    Scene shown;    // with the edits
    RayScene rays;  // of `shown`: for picking and for reflections
    EditHistory edits;
    std::filesystem::file_time_type writeTime;  // of the file as it was read

  private:
    SceneEdits applied_;  // to `shown`
    SceneEdits inFile_;
};

}  // namespace phat
