// Pass A of the lookup: what a pixel's lobes see by its own draws alone. pool.frag adds its neighbours'.
#include "lib/visible_surface.glsl"
#include "lib/lookup.glsl"
#include "lib/packed_draws.glsl"

uniform int alphaMode;
uniform int surfaceIndex;

layout(location = 0) out uvec4 seen;  // see packed_draws.glsl
layout(location = 1) out vec4 place;  // atlas texel; whether there is a coat; with COUNT_READS, reads so far
#ifdef CLEARCOAT
layout(location = 2) out uvec4 seenCoat;
#endif

uvec4 drawsOf(vec4 sum, vec3 mirror, uint surface, float alpha) {
    return packDraws(Draws(sum.rgb / max(sum.a, 1e-30), sum.a, mirror, surface, alpha));
}

void main() {
    if (alphaMode == 1 && opacity() < material[3].a) discard;
    seen = uvec4(0u);
    place = vec4(0.0);
#ifdef CLEARCOAT
    seenCoat = uvec4(0u);
#endif
    vec4 rows[kFactorRows];
    for (int i = 0; i < kFactorRows; ++i) rows[i] = material[i];
    VisibleSurface s = visibleSurface(unpackFactors(rows));
    if (s.chart == kNoChart) return;

    ivec2 inGroup = ivec2(gl_FragCoord.xy) & 3;
    int rank = 4 * inGroup.y + inGroup.x;
    Receiver receiver = Receiver(vPosition, s.towardEye, s.normalGeometric, s.texel, s.chart);
    vec3 normal = s.worldFromLocal[2];
    vec3 mirror = reflect(-s.towardEye, normal);
    uint surface = uint(2 * surfaceIndex + (gl_FrontFacing ? 1 : 2));
    Lobe base = Lobe(normal, maxComponent(s.brdf.f0), s.brdf.f90, s.brdf.alpha);
    vec4 sum = vec4(0.0);
    if (base.f0 > 0.0 || base.f90 > 0.0) sum = lookUp(receiver, base, rank);
    seen = drawsOf(sum, mirror, surface, base.alpha);
    place.xy = s.texel;
#ifdef CLEARCOAT
    if (s.brdf.clearcoat > 0.0) {
        Lobe coat = Lobe(s.worldFromLocal * s.brdf.clearcoatNormal, kClearcoatF0, 1.0, s.brdf.clearcoatAlpha);
        vec4 coatSum = lookUp(receiver, coat, rank);
        seenCoat = drawsOf(coatSum, reflect(-s.towardEye, coat.normal), surface, coat.alpha);
        place.z = 1.0;
    }
#endif
#ifdef COUNT_READS
    place.w = float(readCount);
#endif
}
