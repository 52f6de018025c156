#pragma once
// phat export --lightmap.

#include <CLI/CLI.hpp>
#include <string>

#include "io/phat/lightmap_files.h"

namespace phat {

struct LightmapOptions {
    std::string folder;  // empty: no lightmap
    LightmapLight light = LightmapLight::area;
    bool directional = false;
    bool frontOnly = false;
    uint32_t pageSize = 4096;  // texels of a side, at most
    bool quiet = false;
};

/// Declares the flags of the command that fill `options`, which must outlive it.
void declareLightmap(CLI::App& command, LightmapOptions& options);

/// Writes the folder. `source`: as readBakedFile has left it. Throws FileError, before anything is written.
void exportLightmap(const LightmapOptions& options, const GltfSource& source, const BakedScene& baked);

}  // namespace phat
