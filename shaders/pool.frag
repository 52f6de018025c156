// Pass B of the lookup: neighbouring pixels drew different directions; each takes over those of its neighbours that
// see nearly the same. The tent is two 4x4 boxes, so that each of the 16 sets of draws counts equally. Twice: ACROSS,
// along the rows, then along the columns.
// Lobes of area lights come from the pyramid, by the texel that the pixel shows.
#include "lib/cone.glsl"
#include "lib/packed_draws.glsl"

uniform usampler2D seen;
#ifdef CLEARCOAT
uniform usampler2D seenCoat;
#endif

#ifdef ACROSS
layout(location = 0) out uvec4 pooled;
#ifdef CLEARCOAT
layout(location = 1) out uvec4 pooledCoat;
#endif
const ivec2 kStep = ivec2(1, 0);
#else
uniform sampler2D places;
#ifdef AREA
uniform sampler2DArray relit;  // see display.frag
uniform sampler2DArray radii;
#endif
// sum of weights times radiance, sum of weights; as GLOSSY_LAYERS in display.frag.
layout(location = 0) out vec4 indirect;
layout(location = 1) out vec4 area;
#ifdef CLEARCOAT
layout(location = 2) out vec4 indirectCoat;
layout(location = 3) out vec4 areaCoat;
#endif
const ivec2 kStep = ivec2(0, 1);
#endif

const int kReach = 3;
// A neighbour whose mirror direction is a lobe's width away sees other things. On planes the width that measured
// best was 1.4 alpha, on curves 1 (design study); one number serves both within a tenth.
const float kWidthPerAlpha = 1.2;

// sum of weights times radiance, sum of weights of the pixels along kStep.
vec4 pool(usampler2D drawn, Draws mine) {
    ivec2 p = ivec2(gl_FragCoord.xy);
    ivec2 last = textureSize(drawn, 0) - 1;
    float width = kWidthPerAlpha * max(mine.alpha, 1e-3);
    float sharpness = 0.5 / (width * width);
    vec4 sum = float(kReach + 1) * mine.weight * vec4(mine.radiance, 1.0);
    for (int i = -kReach; i <= kReach; ++i) {
        ivec2 at = p + i * kStep;
        if (i == 0 || any(lessThan(at, ivec2(0))) || any(greaterThan(at, last))) continue;
        Draws other = unpackDraws(READ(texelFetch(drawn, at, 0)));
        if (other.surface != mine.surface) continue;
        vec3 apart = other.mirror - mine.mirror;
        float weight = float(kReach + 1 - abs(i)) * exp(-dot(apart, apart) * sharpness);
        sum += weight * other.weight * vec4(other.radiance, 1.0);
    }
    return sum;
}

#ifdef ACROSS
uvec4 pooledDraws(usampler2D drawn, Draws mine) {
    vec4 sum = pool(drawn, mine);
    mine.radiance = sum.rgb / max(sum.a, 1e-30);
    mine.weight = sum.a;
    return packDraws(mine);
}

void main() {
    pooled = READ(texelFetch(seen, ivec2(gl_FragCoord.xy), 0));
    Draws mine = unpackDraws(pooled);
    if (mine.surface != 0u) pooled = pooledDraws(seen, mine);
#ifdef CLEARCOAT
    pooledCoat = READ(texelFetch(seenCoat, ivec2(gl_FragCoord.xy), 0));
    Draws coat = unpackDraws(pooledCoat);
    if (coat.surface != 0u) pooledCoat = pooledDraws(seenCoat, coat);
#endif
#ifdef COUNT_READS
    pooled.x = uint(readCount);
#endif
}
#else
void main() {
    ivec2 p = ivec2(gl_FragCoord.xy);
    indirect = area = vec4(0.0);
#ifdef CLEARCOAT
    indirectCoat = areaCoat = vec4(0.0);
#endif
    uvec4 bits = READ(texelFetch(seen, p, 0));
    Draws mine = unpackDraws(bits);
    if (mine.surface == 0u) return;
    indirect = pool(seen, mine);
#ifdef CLEARCOAT
    Draws coat = unpackDraws(READ(texelFetch(seenCoat, p, 0)));
    if (coat.surface != 0u) indirectCoat = pool(seenCoat, coat);
#endif
#ifdef COUNT_READS
    indirect = vec4(vec3(texelFetch(places, p, 0).w + float(bits.x) + float(readCount)), 1.0);
#endif
#ifdef AREA
    vec4 place = texelFetch(places, p, 0);
    uint chart = chartAt(ivec2(floor(place.xy)));
    area = lobeSum(relit, radii, 1, place.xy, chart);
#ifdef CLEARCOAT
    if (place.z > 0.0) areaCoat = lobeSum(relit, radii, 3, place.xy, chart);
#endif
#endif
}
#endif
