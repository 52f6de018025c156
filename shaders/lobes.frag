// The lobes of the surface that a pixel shows, for the passes that look light up or trace rays for it. A pass of its own,
// because drivers compile a program anew for every combination of the textures that materials bind, and those are long.
// With TRACED also where the surface is, and how near what its lobes reflect: all that reflect are traced.
#include "lib/atlas.glsl"
#include "lib/octahedral.glsl"
#include "lib/visible_surface.glsl"
#ifdef TRACED
#include "lib/traced_weight.glsl"
#endif

uniform int alphaMode;
uniform int surfaceIndex;

layout(location = 0) out uvec4 reflectance;  // see lib/lobe_pixels.glsl
layout(location = 1) out vec4 base;
#ifdef CLEARCOAT
layout(location = 2) out vec4 coat;
#ifdef TRACED
layout(location = 3) out uvec4 point;
#endif
#else
#ifdef TRACED
layout(location = 2) out uvec4 point;  // bits of the position, world; the flat triangle's normal, octahedral
#endif
#endif

uint tracedBits(vec4 lobe, VisibleSurface s) {
#ifdef TRACED
    return packHalf2x16(vec2(1.0, nearestAround(lobe.xyz, vPosition, s.towardEye, s.texel, s.chart) / unitMeters));
#else
    return 0u;
#endif
}

void main() {
    vec4 rows[kFactorRows];
    for (int i = 0; i < kFactorRows; ++i) rows[i] = material[i];
    VisibleSurface s = visibleSurface(unpackFactors(rows));
    if (alphaMode == 1 && opacity() < material[3].a) discard;
    float f0 = maxComponent(s.brdf.f0);
    base = vec4(s.worldFromLocal[2], s.brdf.alpha);
    uint tracedCoat = 0u;
#ifdef CLEARCOAT
    coat = vec4(0.0);
    if (s.brdf.clearcoat > 0.0) {
        coat = vec4(s.worldFromLocal * s.brdf.clearcoatNormal, s.brdf.clearcoatAlpha);
        if (s.chart != kNoChart) tracedCoat = tracedBits(coat, s);
    }
#endif
    bool reflects = s.chart != kNoChart && (f0 > 0.0 || s.brdf.f90 > 0.0);
    uint surface = uint(2 * surfaceIndex + (gl_FrontFacing ? 1 : 2));
    reflectance = uvec4(packHalf2x16(vec2(f0, s.brdf.f90)), surface, reflects ? tracedBits(base, s) : 0u, tracedCoat);
#ifdef TRACED
    point = uvec4(floatBitsToUint(vPosition), packSnorm2x16(octahedralFromDirection(s.normalGeometric)));
#endif
}
