#pragma once
// The surface under every texel on the GPU. Relighting reads it and the lookup does not, so it is made with
// the first pyramid.

#include "core/atlas/atlas.h"
#include "core/scene/scene.h"
#include "gl/gl_objects.h"

namespace phat {

/// All [y][x] of the atlas.
struct GpuTexelSurfaces {
    GlTexture normals;        // RGBA16_SNORM: octahedral shading normal, coat normal
    GlTexture materialIndex;  // R32UI
    GlTexture texturesA;      // RGBA8: mean base colour, roughness, metallic, specular
    GlTexture texturesB;      // RGBA8: mean specular colour, clearcoat, clearcoat roughness
};

/// By core/shading, so that relighting uses the surfaces of the bake. `points` of the atlas, of which
/// triangles and barycentric coordinates alone are read. Throws GlError.
GpuTexelSurfaces uploadTexelSurfaces(const Scene& scene, const Atlas& atlas, const TexelPoints& points);

/// Normals anew, where charts have turned.
void updateNormals(const GpuTexelSurfaces& gpu, const Scene& scene, const Atlas& atlas,
                   const TexelPoints& points);

}  // namespace phat
