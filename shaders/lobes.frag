// The lobes of the surface that a pixel shows, for lookup.frag. A pass of its own, because drivers compile a program anew
// for every combination of the textures that materials bind, and the lookup is long.
#include "lib/atlas.glsl"
#include "lib/visible_surface.glsl"

uniform int alphaMode;
uniform int surfaceIndex;

layout(location = 0) out vec4 reflectance;  // F0 without colour, F90, and the surface and its side as in LobeSums
layout(location = 1) out vec4 base;         // world normal, alpha
#ifdef CLEARCOAT
layout(location = 2) out vec4 coat;  // the same; alpha 0: none
#endif

void main() {
    vec4 rows[kFactorRows];
    for (int i = 0; i < kFactorRows; ++i) rows[i] = material[i];
    VisibleSurface s = visibleSurface(unpackFactors(rows));
    if (alphaMode == 1 && opacity() < material[3].a) discard;
    float surface = float(2 * surfaceIndex + (gl_FrontFacing ? 1 : 2));
    reflectance = vec4(maxComponent(s.brdf.f0), s.brdf.f90, surface, 0.0);
    base = vec4(s.worldFromLocal[2], s.brdf.alpha);
#ifdef CLEARCOAT
    coat = vec4(0.0);
    if (s.brdf.clearcoat > 0.0) coat = vec4(s.worldFromLocal * s.brdf.clearcoatNormal, s.brdf.clearcoatAlpha);
#endif
}
