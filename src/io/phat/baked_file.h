#pragma once
// The .phat.glb file: the input scene, an atlas UV set and the PHATexels (docs/format.md).

#include <optional>
#include <string>
#include <vector>

#include "core/bake/bake.h"
#include "core/bvh/scene_bvh.h"
#include "core/probes/light_probes.h"
#include "io/base/file_error.h"
#include "io/gltf/gltf_loader.h"
#include "io/phat/baked_inputs.h"

namespace phat {

/// How a file holds its PHATexels. In memory they are PackedPhatexel whatever the file has.
enum class PhatexelStorage : uint8_t {
    packed,  // PackedPhatexel
    paper,   // PackedPhatexel16: no distances
};

/// What a baked file says of its making; printed by `phat info`.
struct BakeRecord {
    std::string generator;  // "phatextures 0.1.0"
    std::string source;     // file name without folders
    std::string settings;   // the bake's flags as one line of JSON
    uint64_t seed = 1;
    PhatexelStorage storage = PhatexelStorage::packed;  // as the file is, or is to be, written
};

struct BakedScene {
    LoadedScene loaded;
    Atlas atlas;
    TexelPoints points;  // rebuilt from the atlas, with the stored occluded states
    Phatexture phatexture;
    std::optional<SceneBvh> bvh;  // where the file has trees, and they are those of the scene
    LightProbes probes;           // none in files that were baked without
    BakeRecord record;
    BakedInputs inputs;
};

/// Whether the file carries the extension PHAT_photon_accumulation_texture.
bool isBakedFile(const GltfSource& source);
/// The same of a file that is not open. Throws FileError if unreadable.
bool isBakedFile(const std::string& path);

/// Of a baked file. Throws FileError where this program does not read its version or its storage.
PhatexelStorage phatexelStorage(const GltfSource& source);

/// A baked file would be larger than it may be; nothing was written.
struct FileTooLarge : FileError {
    FileTooLarge(const std::string& file, uint64_t size);
    uint64_t bytes;
};

struct BakedFileOptions {
    Progress* progress = nullptr;  // of the compression
    const LightProbes* probes = nullptr;
    uint64_t mostBytes = ~uint64_t(0);       // of the file
    std::optional<BakedInputs> inputs = {};  // none: a later bake takes over nothing
};

/// Rewrites `source` with the atlas and the PHATexels into `outPath`. `scene` must be what loadGltf(source)
/// gave (plus its environment and added lights, which are stored too). Returns what of the input could not be
/// kept, one line each. Throws FileError, FileTooLarge when the file would have more than `mostBytes`, and
/// Interrupted when `progress` was asked to stop; an old file at `outPath` then stays as it was. pre:
/// loadGltf has read `source`.
std::vector<std::string> writeBakedFile(const std::string& outPath, const GltfSource& source,
                                        const Scene& scene, const Bake& bake, const BakeRecord& record,
                                        const BakedFileOptions& options = {});
/// The same of a file that is not open; `loaded`: as `scene` was loaded.
std::vector<std::string> writeBakedFile(const std::string& outPath, const std::string& sourcePath,
                                        const Scene& scene, const Bake& bake, const BakeRecord& record,
                                        const GltfLoadOptions& loaded = {});

/// About how many texels a baked file of `bytes` has room for; `sceneBytes`: what the scene itself takes.
uint64_t texelsThatFit(uint64_t bytes, uint64_t sceneBytes, int layers, bool areaLights,
                       PhatexelStorage storage);

/// Throws FileError when anything is missing, truncated or inconsistent.
BakedScene readBakedFile(const std::string& path);
/// The same of a file that is open; reads its buffers. pre: they are not read yet.
BakedScene readBakedFile(GltfSource& source);

}  // namespace phat
