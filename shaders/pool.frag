// Pass B of the lookup: neighbouring pixels drew different directions; each takes over those of its neighbours that
// see nearly the same. The tent is two 4x4 boxes, so that each of the 16 sets of draws counts equally.
// Lobes of area lights come from the pyramid, by the texel that the pixel shows.
#include "lib/cone.glsl"

uniform sampler2D seen;
uniform sampler2D surfaces;
uniform sampler2D places;
#ifdef CLEARCOAT
uniform sampler2D seenCoat;
#endif
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

const int kReach = 3;
// A neighbour whose mirror direction is a lobe's width away sees other things. On planes the width that measured
// best was 1.4 alpha, on curves 1 (design study); one number serves both within a tenth.
const float kWidthPerAlpha = 1.2;

void main() {
    ivec2 p = ivec2(gl_FragCoord.xy);
    vec4 mine = texelFetch(surfaces, p, 0);
    vec4 place = texelFetch(places, p, 0);
    indirect = area = vec4(0.0);
#ifdef CLEARCOAT
    indirectCoat = areaCoat = vec4(0.0);
#endif
    if (mine.w == 0.0) return;

    vec2 width = kWidthPerAlpha * max(place.zw, vec2(1e-3));
    vec2 sharpness = 0.5 / (width * width);
    ivec2 last = textureSize(seen, 0) - 1;
    for (int y = -kReach; y <= kReach; ++y) {
        for (int x = -kReach; x <= kReach; ++x) {
            ivec2 at = p + ivec2(x, y);
            if (any(lessThan(at, ivec2(0))) || any(greaterThan(at, last))) continue;
            vec4 other = texelFetch(surfaces, at, 0);
            if (other.w != mine.w) continue;
            float tent = float((kReach + 1 - abs(x)) * (kReach + 1 - abs(y)));
            vec3 apart = other.xyz - mine.xyz;
            vec2 weight = tent * exp(-dot(apart, apart) * sharpness);
            indirect += weight.x * texelFetch(seen, at, 0);
#ifdef CLEARCOAT
            indirectCoat += weight.y * texelFetch(seenCoat, at, 0);
#endif
        }
    }
#ifdef AREA
    uint chart = chartAt(ivec2(floor(place.xy)));
    area = lobeSum(relit, radii, 1, place.xy, chart);
#ifdef CLEARCOAT
    if (place.w > 0.0) areaCoat = lobeSum(relit, radii, 3, place.xy, chart);
#endif
#endif
}
