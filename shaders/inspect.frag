// Views of the data in the atlas, drawn on its surfaces instead of the reflected light.
// Values are display-linear in [0, 1] but for the two views of radiance, which are light.
// twin: Inspected in src/gl/renderer.h.
#include "lib/cone.glsl"
#include "lib/heat.glsl"
#include "lib/tile_patch.glsl"

in vec4 vTexel;
flat in uvec2 vCharts;

uniform int inspected;
uniform int layer;
uniform int lobeIndex;              // of relit: 0 indirect light, 1 area lights
uniform int level;                  // of the pyramid
uniform usampler2DArray phatexels;  // [layer][y][x] packed, 8 bytes
uniform usampler2D tilePatches;     // see lib/tile_patch.glsl
uniform sampler2DArray relit;       // see display.frag
uniform sampler2DArray radii;
uniform float coarsestTexelMeters;

layout(location = 0) out vec4 shown;

const int kRadiance = 1;
const int kDirection = 2;
const int kDistance = 3;
const int kValidity = 4;
const int kCharts = 5;
const int kDensity = 6;
const int kPyramid = 7;
const int kSamples = 8;

// Where there is no PHATexel.
const vec3 kNothing = vec3(0.02);
const vec3 kInvalid = vec3(0.8, 0.02, 0.1);

// Neighbours in number are far apart in colour: multiples of the golden ratio around a circle of hues.
vec3 colorOf(uint number) {
    float hue = fract(float(number) * 0.618034);
    return 0.15 + 0.6 * clamp(abs(fract(hue + vec3(0.0, 2.0, 1.0) / 3.0) * 6.0 - 3.0) - 1.0, 0.0, 1.0);
}

// 0 and 1 in turn.
float checker(ivec2 cell) {
    return float((cell.x + cell.y) & 1);
}

vec3 phatexelColor(ivec2 texel) {
    Phatexel phatexel = unpackPhatexel(texelFetch(phatexels, ivec3(texel, layer), 0).xy);
    if (!phatexel.valid) return inspected == kValidity ? kInvalid : kNothing;
    if (inspected == kRadiance) return phatexel.radiance;
    if (inspected == kDistance)  // from .01 to 100 units of length
        return heat(log2(phatexel.distance / (0.01 * unitMeters)) / log2(1e4));
    if (inspected == kValidity) return vec3(0.05, 0.4, 0.1);
    ivec2 tile = texel >> 3;
    TilePatch tilePatch = tilePatchAt(tilePatches, tile, texelSizeOfTile(tile));
    return 0.5 + 0.5 * (tilePatch.worldFromBlock * phatexel.directionBlock);
}

// A texel is a square, a tile eight of them; blue where texels are as coarse as anywhere, red where an eighth.
vec3 densityColor(ivec2 texel) {
    float finer = log2(coarsestTexelMeters / texelSizeOfTile(texel >> 3)) / 3.0;
    vec3 color = mix(vec3(0.1, 0.25, 0.9), vec3(0.95, 0.3, 0.05), clamp(finer, 0.0, 1.0));
    return color * (0.35 + 0.4 * checker(texel) + 0.25 * checker(texel >> 3));
}

// (sum k a)^2 / sum (k a)^2 over the texels in the cone that the display pass would take; 1 to 256.
vec3 samplesColor(vec2 center, uint chart) {
    float radius = max(coneRadius(radii, lobeIndex, center, chart), kMinRadius);
    ivec4 taps = ivec4(ceil(center - radius - 0.5), floor(center + radius - 0.5));
    float sum = 0.0, squares = 0.0;
    for (int y = taps.y; y <= taps.w; ++y) {
        for (int x = taps.x; x <= taps.z; ++x) {
            float k = 1.0 - length(vec2(x, y) + 0.5 - center) / radius;
            if (k <= 0.0 || chartAt(ivec2(x, y)) != chart) continue;
            float weight = k * texelFetch(relit, ivec3(x, y, lobeIndex), 0).a;
            sum += weight;
            squares += weight * weight;
        }
    }
    return squares > 0.0 ? heat(log2(max(sum * sum / squares, 1.0)) / 8.0) : kInvalid;
}

void main() {
    shown = vec4(kNothing, 1.0);
    uint chart = gl_FrontFacing ? vCharts.x : vCharts.y;
    if (chart == kNoChart) return;
    vec2 center = gl_FrontFacing ? vTexel.xy : vTexel.zw;
    ivec2 texel = ivec2(floor(center));
    // Interpolation may end a hair beyond the chart.
    if (chartAt(texel) != chart) return;
    if (inspected == kCharts) {
        shown.rgb = colorOf(chart) * (0.85 + 0.15 * checker(texel >> 3));
    } else if (inspected == kDensity) {
        shown.rgb = densityColor(texel);
    } else if (inspected == kPyramid) {
        vec4 sum = texelFetch(relit, ivec3(texel >> level, lobeIndex), level);
        shown.rgb = sum.a > 0.0 ? sum.rgb / sum.a : kNothing;
    } else if (inspected == kSamples) {
        shown.rgb = samplesColor(center, chart);
    } else {
        shown.rgb = phatexelColor(texel);
    }
}
