#pragma once
// A glTF file again, as one self-contained GLB whose surfaces carry the atlas as one more UV set.

#include <string>
#include <vector>

#include "core/atlas/atlas.h"
#include "core/atlas/surface_part.h"
#include "io/gltf/glb_builder.h"
#include "io/gltf/gltf_source.h"

namespace phat {

inline constexpr const char* kPhatExtension = "PHAT_photon_accumulation_texture";

/// Where a part of a surface has come to be.
struct RewrittenPart {
    size_t mesh = 0, primitive = 0;
    uint32_t page = 0;
    bool oneSided = false;
};

struct RewrittenGltf {
    GlbBuilder glb;
    uint32_t texCoord = 1;             // the atlas is TEXCOORD_texCoord of every surface
    std::vector<RewrittenPart> parts;  // in the order of the surfaces
    std::vector<std::string> notes;    // what could not be kept
};

/// Every surface's primitive gets vertices of its own, split where the atlas needs it, and an indexed
/// triangle list in the scene's order; every node with surfaces gets a mesh of its own. Materials, images,
/// nodes, cameras, lights, animations and extras stay. An earlier bake's extension and UV set are taken out.
/// pre: `scene` was loaded from `source`. Throws std::runtime_error where the two do not fit.
RewrittenGltf rewriteGltf(const GltfSource& source, const Scene& scene, const Atlas& atlas);
/// The same of surfaces in parts, `parts[surface]`: the first is in place of the surface's own primitive, the
/// others are behind those of its mesh. pre: every triangle of a surface is in one of them at least.
RewrittenGltf rewriteGltf(const GltfSource& source, const Scene& scene,
                          const std::vector<std::vector<SurfacePart>>& parts);

/// Between texel coordinates of the atlas and its UV set. The two are inverse up to float rounding: a round
/// trip is off by a few units in the last place, which the file's texelCorrection undoes.
inline glm::vec2 uvFromTexel(glm::vec2 texel, glm::uvec2 sizeTexels) {
    return texel / glm::vec2(sizeTexels);
}
inline glm::vec2 texelFromUv(glm::vec2 uv, glm::uvec2 sizeTexels) {
    return uv * glm::vec2(sizeTexels);
}

}  // namespace phat
