// What ray tracing needs of a pixel: which triangle it shows, and the lobes there with textures and normal maps as they
// are drawn. src/core/render/traced_reflections.h traces them.
#include "lib/atlas.glsl"
#include "lib/visible_surface.glsl"
#include "lib/traced_weight.glsl"

uniform int alphaMode;

flat in uint vTriangle;

layout(location = 0) out vec4 base;  // world normal; alpha, 0: no lobe
layout(location = 1) out vec4 coat;  // the same
// Twice the triangle's index + 1 for its back, + 1; then halves: F0 and F90, tracedWeight of the base and of the coat.
layout(location = 2) out uvec4 surface;

uint packedWeightOf(vec4 lobe, VisibleSurface s) {
    return packHalf2x16(tracedWeight(lobe.xyz, lobe.a, vPosition, s.towardEye, s.texel, s.chart));
}

void main() {
    if (alphaMode == 1 && opacity() < material[3].a) discard;
    vec4 rows[kFactorRows];
    for (int i = 0; i < kFactorRows; ++i) rows[i] = material[i];
    VisibleSurface s = visibleSurface(unpackFactors(rows));
    float f0 = maxComponent(s.brdf.f0);
    bool reflects = s.chart != kNoChart && (f0 > 0.0 || s.brdf.f90 > 0.0);
    base = vec4(s.worldFromLocal[2], reflects ? s.brdf.alpha : 0.0);
    coat = vec4(0.0);
#ifdef CLEARCOAT
    if (s.chart != kNoChart && s.brdf.clearcoat > 0.0)
        coat = vec4(s.worldFromLocal * s.brdf.clearcoatNormal, s.brdf.clearcoatAlpha);
#endif
    uint side = 2u * vTriangle + (gl_FrontFacing ? 1u : 2u);
    surface = uvec4(side, packHalf2x16(vec2(f0, s.brdf.f90)), packedWeightOf(base, s), packedWeightOf(coat, s));
}
