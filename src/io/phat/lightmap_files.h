#pragma once
// A bake as a plain glTF file with lightmaps beside it (docs/lightmap.md).

#include <map>
#include <string>
#include <vector>

#include "core/atlas/atlas_pages.h"
#include "core/render/lightmap.h"
#include "io/phat/baked_file.h"

namespace phat {

/// The names that flags and files use.
const std::map<std::string, LightmapLight>& lightmapLightNames();

struct LightmapFile {
    std::string name;
    std::vector<uint8_t> bytes;
};

/// What of a bake goes into the files. All outlive it.
struct LightmapExport {
    const GltfSource& source;  // as readBakedFile has left it
    const BakedScene& baked;
    const AtlasPages& pages;
    std::string stem;  // of the scene's name
    LightmapLight light = LightmapLight::area;
    bool directional = false;  // also where the light comes from
    PartSides sides = PartSides::both;
};

/// The names of lightmapFiles, known before the light.
std::vector<std::string> lightmapFileNames(const LightmapExport& what);

/// The scene, the pages as OpenEXR and as RGBM in PNG, and what describes them. What of the scene could not
/// be kept is added to `notes`. Throws std::runtime_error, and Interrupted when `progress` was asked to stop.
std::vector<LightmapFile> lightmapFiles(const LightmapExport& what, Progress& progress,
                                        std::vector<std::string>& notes);

}  // namespace phat
