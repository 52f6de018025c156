#pragma once
// glTF 2.0 files to Scene.

#include <optional>
#include <string>
#include <vector>

#include "core/atlas/atlas.h"
#include "core/scene/scene.h"

namespace phat {

struct GltfSource;  // io/gltf/gltf_source.h

struct LoadedScene {
    Scene scene;
    /// One line each: what was dropped, mended or is shown in one pose, by name.
    std::vector<std::string> notes;
    double wallTexelSizeMeters = 0;  // that walls divided surfaces for; 0: they did not
};

/// The photometric file that a light of the scene is to have.
struct NamedPhotometry {
    std::string light;           // its name
    std::string path;            // of the file
    std::vector<uint8_t> bytes;  // of the file; they can be read
    double multiplier = 1;
};

struct GltfLoadOptions {
    std::string variant;  // of KHR_materials_variants; empty: the materials that primitives have of their own
    std::optional<AtlasSettings> divideFor =
        {};                          // divide surfaces at walls (divided_surfaces.h) for this atlas
    double wallTexelSizeMeters = 0;  // for texels of this size then; 0: of the size that is to be expected
    std::vector<NamedPhotometry> photometries = {};
};

/// Loads a .glb or .gltf file (buffers and images embedded, as data URIs, or beside it; never from outside
/// its folder, never over a network). Every count, offset and stride is checked before memory is allocated.
/// Throws FileError with the reason.
LoadedScene loadGltf(const std::string& path);
/// The same of a file that is open; reads its buffers into `source` and makes it plain: compressed data,
/// instances, poses and the like are from then on what any glTF file has, and the scene's indices are those
/// of `source` (gltf_plain.h). pre: the buffers are not read yet.
LoadedScene loadGltf(GltfSource& source, const GltfLoadOptions& options = {});

/// Reads a latitude-longitude .hdr or .exr picture. Infinite pixels become the largest half or, if it is
/// more, the largest finite value; what is no number and what is negative becomes 0. Says so in `notes`, if
/// given. Throws FileError.
Environment loadEnvironment(const std::string& path, std::vector<std::string>* notes = nullptr);

}  // namespace phat
