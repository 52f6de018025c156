#include "io/phat/earlier_file.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "io/base/file_error.h"
#include "io/base/printable.h"
#include "io/gltf/same_surfaces.h"
#include "io/phat/bake_record.h"

namespace phat {
namespace {

using nlohmann::json;

// The flags that texels depend on, by their names in the record.
constexpr std::pair<const char*, const char*> kAtlasFlags[] = {{"resolution", "--resolution"},
                                                               {"texelSize", "--texel-size"},
                                                               {"glossyDensity", "--glossy-density"},
                                                               {"gutter", "--gutter"},
                                                               {"useUv", "--use-uv"}};

std::string flagOf(const char* flag, const json& value) {
    return value.is_null() ? fmt::format("without {}", flag) : fmt::format("with {} {}", flag, value.dump());
}

void checkRecord(const std::string& path, const BakeRecord& found, const BakeRecord& asked) {
    if (found.generator != asked.generator)
        throw FileError(path, fmt::format("was baked by \"{}\", and this is \"{}\": bake anew",
                                          printable(found.generator), asked.generator));
    const json before = settingsJson(found.settings), now = settingsJson(asked.settings);
    for (const auto& [name, flag] : kAtlasFlags) {
        const json was = before.value(name, json()), is = now.value(name, json());
        if (was == is) continue;
        throw FileError(path, fmt::format("was baked {}, not {}: give the same, or bake anew",
                                          printable(flagOf(flag, was)), flagOf(flag, is)));
    }
}

}  // namespace

std::unique_ptr<const EarlierFile> openEarlier(const std::string& path, const BakeRecord& record) {
    auto file = std::make_unique<EarlierFile>();
    file->source = openGltf(path);
    if (!isBakedFile(file->source)) throw FileError(path, "is not a baked file");
    file->baked = readBakedFile(file->source);
    checkRecord(path, file->baked.record, record);
    return file;
}

EarlierBake earlierBake(const EarlierFile& earlier, const GltfSource& source, const Scene& scene,
                        bool withResults) {
    const BakedScene& baked = earlier.baked;
    EarlierBake result{{baked.atlas, baked.loaded.scene.surfaces, {}}, {}};
    try {
        result.charts.earlierSurface = sameSurfaces({source, scene}, {earlier.source, baked.loaded.scene});
    } catch (const std::exception& error) {
        throw FileError(source.path, error.what());
    }
    if (!withResults) return result;
    StageKeys keys = baked.inputs.keys;
    // The paper's storage rounds PHATexels.
    if (baked.record.storage != PhatexelStorage::packed) keys.all = keys.areaLight = 0;
    result.results.emplace(EarlierResults{baked.points, baked.phatexture, keys});
    return result;
}

}  // namespace phat
