#pragma once
// A glTF file again, as one self-contained GLB whose surfaces carry the atlas as one more UV set.

#include <string>
#include <vector>

#include "core/atlas/atlas.h"
#include "io/gltf/glb_builder.h"
#include "io/gltf/gltf_source.h"

namespace phat {

inline constexpr const char* kPhatExtension = "PHAT_photon_accumulation_texture";

struct RewrittenGltf {
    GlbBuilder glb;
    uint32_t texCoord = 1;           // the atlas is TEXCOORD_texCoord of every surface
    std::vector<std::string> notes;  // what could not be kept
};

/// Every surface's primitive gets vertices of its own, split where the atlas needs it, and an indexed
/// triangle list in the scene's order; every node with surfaces gets a mesh of its own. Materials, images,
/// nodes, cameras, lights, animations and extras stay. An earlier bake's extension and UV set are taken out.
/// pre: `scene` was loaded from `source`. Throws std::runtime_error where the two do not fit.
RewrittenGltf rewriteGltf(const GltfSource& source, const Scene& scene, const Atlas& atlas);

/// Between texel coordinates of the atlas and its UV set. The two are inverse up to float rounding: a round
/// trip is off by a few units in the last place, which the file's texelCorrection undoes.
inline glm::vec2 uvFromTexel(glm::vec2 texel, glm::uvec2 sizeTexels) {
    return texel / glm::vec2(sizeTexels);
}
inline glm::vec2 texelFromUv(glm::vec2 uv, glm::uvec2 sizeTexels) {
    return uv * glm::vec2(sizeTexels);
}

}  // namespace phat
