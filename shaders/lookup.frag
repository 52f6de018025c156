// Pass A of the lookup: the incident light under a pixel's lobes, by its own samples. pool.frag adds those of its
// neighbours.
#include "lib/lobe_pixels.glsl"
#include "lib/visible_point.glsl"
#include "lib/lookup.glsl"
#include "lib/sums_out.glsl"

in vec3 vNormal;

uniform int surfaceIndex;

LobeSums sumsOf(Receiver receiver, PixelLobe lobe, int rank) {
    LobeSums d = noLobeSums();
    d.mirror = reflect(-receiver.towardEye, lobe.normal);
    d.alpha = lobe.alpha;
    // What is wholly traced need not be looked up.
    if ((lobe.f0 > 0.0 || lobe.f90 > 0.0) && lobe.weight < 1.0) {
        IncidentSums light = lookUp(receiver, ScalarLobe(lobe.normal, lobe.f0, lobe.f90, lobe.alpha), rank, d.alpha);
        d.indirect = light.indirect;
        d.cosine = light.indirect.a * light.cosine.x / max(light.cosine.y, 1e-30);
        d.area = light.area;
        d.areaByLight = light.areaByLight;
    }
    return d;
}

void main() {
    VisiblePoint point = visiblePoint();
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    uint surface = uint(2 * surfaceIndex + (gl_FrontFacing ? 1 : 2));
    PixelLobe base = pixelLobe(pixel, kBaseLobe);
    // Another surface at the same depth, of which this one is a part that was cut out.
    if (base.surface != surface) discard;
    writeNothing();
    if (point.chart == kNoChart) return;

    vec3 normal = faceforward(normalize(vNormal), -point.normalGeometric, vNormal);
    Receiver receiver =
        Receiver(vPosition, point.towardEye, normal, point.normalGeometric, point.texel, point.chart);
    int lobes = 1;
#ifdef CLEARCOAT
    if (pixelLobe(pixel, kCoatLobe).alpha > 0.0) lobes = 2;
#endif
    // A loop: drivers inline all functions, and the code of a lobe is long.
    for (int lobe = 0; lobe < lobes; ++lobe) {
        LobeSums sums = sumsOf(receiver, pixelLobe(pixel, lobe), rankOf(pixel));
        sums.surface = surface;
        writeLobe(lobe, sums);
    }
#ifdef COUNT_READS
    addReads(0u, 0u);
#endif
}
