// Pass A of the lookup: what a pixel's lobes see by its own draws alone. pool.frag adds its neighbours'.
#include "lib/visible_surface.glsl"
#include "lib/lookup.glsl"

uniform int alphaMode;
uniform int surfaceIndex;

layout(location = 0) out vec4 seen;     // sum g L, sum g
layout(location = 1) out vec4 surface;  // mirror direction; surface and side, 0: none
layout(location = 2) out vec4 place;    // atlas texel, alpha and the coat's as they were drawn
#ifdef CLEARCOAT
layout(location = 3) out vec4 seenCoat;
#endif

void main() {
    if (alphaMode == 1 && opacity() < material[3].a) discard;
    seen = vec4(0.0);
    surface = vec4(0.0);
    place = vec4(0.0);
#ifdef CLEARCOAT
    seenCoat = vec4(0.0);
#endif
    vec4 rows[kFactorRows];
    for (int i = 0; i < kFactorRows; ++i) rows[i] = material[i];
    VisibleSurface s = visibleSurface(unpackFactors(rows));
    if (s.chart == kNoChart) return;

    ivec2 inGroup = ivec2(gl_FragCoord.xy) & 3;
    int rank = 4 * inGroup.y + inGroup.x;
    Receiver receiver = Receiver(vPosition, s.towardEye, s.normalGeometric, s.texel, s.chart);
    vec3 normal = s.worldFromLocal[2];
    Lobe base = Lobe(normal, maxComponent(s.brdf.f0), s.brdf.f90, s.brdf.alpha);
    if (base.f0 > 0.0 || base.f90 > 0.0) seen = lookUp(receiver, base, rank);
    surface = vec4(reflect(-s.towardEye, normal), float(2 * surfaceIndex + (gl_FrontFacing ? 1 : 2)));
    place = vec4(s.texel, base.alpha, 0.0);
#ifdef CLEARCOAT
    if (s.brdf.clearcoat > 0.0) {
        Lobe coat = Lobe(s.worldFromLocal * s.brdf.clearcoatNormal, kClearcoatF0, 1.0, s.brdf.clearcoatAlpha);
        seenCoat = lookUp(receiver, coat, rank);
        place.w = coat.alpha;
    }
#endif
}
