// Pass B of the lookup: neighbouring pixels sampled different directions; each adds the sums of those neighbours whose
// lobes point nearly the same way. The tent is two 4x4 boxes, so that each of the 16 sets of sample numbers counts
// equally. Drawn twice: along the rows, then along the columns.
#include "lib/packed_sums.glsl"

uniform usampler2DArray incident;  // the layers of lib/sums_out.glsl
uniform ivec2 alongWhich;      // (1, 0) or (0, 1)

#include "lib/sums_out.glsl"

const int kReach = 3;
// A neighbour whose mirror direction is a lobe's width away reflects other things. On planes the width that measured
// best was 1.4 alpha, on curves 1 (design study); one number serves both within a tenth.
const float kWidthPerAlpha = 1.2;

LobeSums sumsAt(ivec2 p, int lobe) {
    LobeSums d = unpackLobeSums(READ(texelFetch(incident, ivec3(p, lobe * kLayersPerLobe), 0)));
#ifdef AREA
    READS_FOR(1);
    unpackAreaSums(READ(texelFetch(incident, ivec3(p, lobe * kLayersPerLobe + 1), 0)), d);
    READS_FOR(0);
#endif
    return d;
}

// The sums of the pixel and of the pixels beside it.
LobeSums pooledSums(int lobe) {
    ivec2 p = ivec2(gl_FragCoord.xy);
    LobeSums mine = sumsAt(p, lobe);
    if (mine.surface == 0u) return mine;
    ivec2 last = textureSize(incident, 0).xy - 1;
    float width = kWidthPerAlpha * max(mine.alpha, 1e-3);
    float sharpness = 0.5 / (width * width);
    mine.indirect *= float(kReach + 1);
    mine.cosine *= float(kReach + 1);
    mine.area *= float(kReach + 1);
    mine.areaByLight *= float(kReach + 1);
    for (int i = -kReach; i <= kReach; ++i) {
        ivec2 at = p + i * alongWhich;
        if (i == 0 || any(lessThan(at, ivec2(0))) || any(greaterThan(at, last))) continue;
        LobeSums other = sumsAt(at, lobe);
        if (other.surface != mine.surface) continue;
        vec3 apart = other.mirror - mine.mirror;
        float weight = float(kReach + 1 - abs(i)) * exp(-dot(apart, apart) * sharpness);
        mine.indirect += weight * other.indirect;
        mine.cosine += weight * other.cosine;
        mine.area += weight * other.area;
        mine.areaByLight += weight * other.areaByLight;
    }
    return mine;
}

void main() {
    for (int lobe = 0; lobe < kLobes; ++lobe) writeLobe(lobe, pooledSums(lobe));
#ifdef COUNT_READS
    addReads(texelFetch(incident, ivec3(gl_FragCoord.xy, 0), 0).y,
             texelFetch(incident, ivec3(gl_FragCoord.xy, kLayersPerLobe - 1), 0).y);
#endif
}
