// Pass A of the lookup: the incident light under a pixel's lobes, by its own samples. pool.frag adds those of its
// neighbours.
#include "lib/visible_surface.glsl"
#include "lib/lookup.glsl"
#include "lib/sums_out.glsl"

uniform int alphaMode;
uniform int surfaceIndex;

LobeSums sumsOf(Receiver receiver, ScalarLobe lobe, int rank) {
    LobeSums d = noLobeSums();
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
    writeBase(noLobeSums());
#ifdef CLEARCOAT
    writeCoat(noLobeSums());
#endif
    vec4 rows[kFactorRows];
    for (int i = 0; i < kFactorRows; ++i) rows[i] = material[i];
    VisibleSurface s = visibleSurface(unpackFactors(rows));
    if (s.chart == kNoChart) return;

    ivec2 inGroup = ivec2(gl_FragCoord.xy) & 3;
    int rank = 4 * inGroup.y + inGroup.x;
    Receiver receiver = Receiver(vPosition, s.towardEye, s.normalGeometric, s.texel, s.chart);
    ScalarLobe specular = ScalarLobe(s.worldFromLocal[2], maxComponent(s.brdf.f0), s.brdf.f90, s.brdf.alpha);
    writeBase(sumsOf(receiver, specular, rank));
#ifdef CLEARCOAT
    if (s.brdf.clearcoat > 0.0) {
        vec3 normalWorld = s.worldFromLocal * s.brdf.clearcoatNormal;
        ScalarLobe clearcoat = ScalarLobe(normalWorld, kClearcoatF0, 1.0, s.brdf.clearcoatAlpha);
        writeCoat(sumsOf(receiver, clearcoat, rank));
    }
#endif
#ifdef COUNT_READS
    addReads(0u, 0u);
#endif
}
