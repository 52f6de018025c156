// Pass A of the lookup: the incident light under a pixel's lobes, by its own samples. pool.frag adds those of its
// neighbours.
#include "lib/visible_point.glsl"
#include "lib/lookup.glsl"
#include "lib/sums_out.glsl"

uniform int surfaceIndex;
// What lobes.frag left of this pixel.
uniform sampler2D reflectances;
uniform sampler2D baseLobes;
#ifdef CLEARCOAT
uniform sampler2D coatLobes;
#endif

ScalarLobe lobeAt(int lobe, ivec2 pixel, vec2 reflectance) {
#ifdef CLEARCOAT
    if (lobe == 1) {
        vec4 coat = texelFetch(coatLobes, pixel, 0);
        return ScalarLobe(coat.xyz, kClearcoatF0, 1.0, coat.a);
    }
#endif
    vec4 base = texelFetch(baseLobes, pixel, 0);
    return ScalarLobe(base.xyz, reflectance.x, reflectance.y, base.a);
}

int lobeCountAt(ivec2 pixel) {
#ifdef CLEARCOAT
    return texelFetch(coatLobes, pixel, 0).a > 0.0 ? 2 : 1;
#else
    return 1;
#endif
}

LobeSums sumsOf(Receiver receiver, ScalarLobe lobe, int rank) {
    LobeSums d = noLobeSums();
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
    VisiblePoint point = visiblePoint();
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    vec4 reflectance = texelFetch(reflectances, pixel, 0);
    int surface = 2 * surfaceIndex + (gl_FrontFacing ? 1 : 2);
    // Another surface at the same depth, of which this one is a part that was cut out.
    if (int(reflectance.z) != surface) discard;
    writeNothing();
    if (point.chart == kNoChart) return;

    ivec2 inGroup = pixel & 3;
    Receiver receiver =
        Receiver(vPosition, point.towardEye, point.normalGeometric, point.texel, point.chart);
    // A loop: drivers inline all functions, and the code of a lobe is long.
    int lobes = lobeCountAt(pixel);
    for (int lobe = 0; lobe < lobes; ++lobe) {
        LobeSums sums = sumsOf(receiver, lobeAt(lobe, pixel, reflectance.xy), 4 * inGroup.y + inGroup.x);
        sums.surface = uint(surface);
        writeLobe(lobe, sums);
    }
#ifdef COUNT_READS
    addReads(0u, 0u);
#endif
}
