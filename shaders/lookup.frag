// Pass A of the lookup: what a pixel's lobes see by its own draws alone. pool.frag adds its neighbours'.
#include "lib/visible_surface.glsl"
#include "lib/lookup.glsl"
#include "lib/draws_out.glsl"

uniform int alphaMode;
uniform int surfaceIndex;

Draws drawsOf(Receiver receiver, ScalarLobe lobe, int rank) {
    Draws d = noDraws();
    d.surface = uint(2 * surfaceIndex + (gl_FrontFacing ? 1 : 2));
    d.mirror = reflect(-receiver.towardEye, lobe.normalWorld);
    d.alpha = lobe.alpha;
    if (lobe.f0 > 0.0 || lobe.f90 > 0.0) {
        IncidentSums light = lookUp(receiver, lobe, rank, d.alpha);
        d.indirect = light.indirect;
        d.area = light.area;
        d.areaByLight = light.areaByLight;
    }
    return d;
}

void main() {
    if (alphaMode == 1 && opacity() < material[3].a) discard;
    writeBase(noDraws());
#ifdef CLEARCOAT
    writeCoat(noDraws());
#endif
    vec4 rows[kFactorRows];
    for (int i = 0; i < kFactorRows; ++i) rows[i] = material[i];
    VisibleSurface s = visibleSurface(unpackFactors(rows));
    if (s.chart == kNoChart) return;

    ivec2 inGroup = ivec2(gl_FragCoord.xy) & 3;
    int rank = 4 * inGroup.y + inGroup.x;
    Receiver receiver = Receiver(vPosition, s.towardEye, s.normalGeometric, s.texel, s.chart);
    ScalarLobe specular = ScalarLobe(s.worldFromLocal[2], maxComponent(s.brdf.f0), s.brdf.f90, s.brdf.alpha);
    writeBase(drawsOf(receiver, specular, rank));
#ifdef CLEARCOAT
    if (s.brdf.clearcoat > 0.0) {
        ScalarLobe clearcoat = ScalarLobe(s.worldFromLocal * s.brdf.clearcoatNormal, kClearcoatF0, 1.0, s.brdf.clearcoatAlpha);
        writeCoat(drawsOf(receiver, clearcoat, rank));
    }
#endif
#ifdef COUNT_READS
    addReads(0u, 0u);
#endif
}
