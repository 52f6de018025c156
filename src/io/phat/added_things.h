#pragma once
// Things beside a bake, from files of their own.

#include <atomic>
#include <string>
#include <vector>

#include "core/base/progress.h"
#include "io/phat/baked_file.h"

namespace phat {

/// The surfaces of several files, where their own nodes put them.
struct LoadedThings {
    Scene scene;
    std::vector<std::string> notes;  // one line each, with the file's name
};

/// Throws FileError, also for a file without triangles.
LoadedThings loadThings(const std::vector<std::string>& paths);

/// Makes the probes of a bake that has none. `rays`: of its scene. Returns whether it made them.
bool completeProbes(BakedScene& baked, const RayScene& rays, Progress& progress);

}  // namespace phat
