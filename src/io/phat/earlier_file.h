#pragma once
// A baked file that another bake continues.

#include <memory>

#include "io/gltf/gltf_source.h"
#include "io/phat/baked_file.h"

namespace phat {

/// It holds what an EarlierBake refers to.
struct EarlierFile {
    GltfSource source;
    BakedScene baked;
};

/// Throws FileError: also for what is no baked file, and for one by another version of the program or of
/// other texels than those of `record`, the bake to come.
std::unique_ptr<const EarlierFile> openEarlier(const std::string& path, const BakeRecord& record);

/// For a bake of `scene`, which was loaded from `source`. `withResults`: or its charts alone. Throws
/// FileError.
EarlierBake earlierBake(const EarlierFile& earlier, const GltfSource& source, const Scene& scene,
                        bool withResults);

}  // namespace phat
