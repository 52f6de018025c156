#pragma once
// A baked file in parts, for pages that show the first while the others are on their way.

#include <cstdint>
#include <string>
#include <vector>

#include "io/gltf/gltf_source.h"

namespace phat {

struct WebPart {
    std::string uri;
    std::vector<uint8_t> bytes;
};

struct WebParts {
    WebPart room;                // a baked GLB: the scene, its diffuse light, and the atlas
    std::vector<WebPart> later;  // buffers of it, in the order in which a page wants them: area lights'
                                 // highlights, then a layer of the indirect light each
};

/// `stem`: of the names, by contentName: STEM.HASH.glb, STEM.lamps.HASH.bin, STEM.reflections.HASH.bin,
/// STEM.reflections-2.HASH.bin ... Together they are the same baked file. Takes a copy of `source`,
/// since its buffers are read. Throws FileError. pre: they are not read yet.
WebParts splitForWeb(GltfSource source, const std::string& stem);

}  // namespace phat
