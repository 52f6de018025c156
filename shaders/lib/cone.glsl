// The neighbourhood of a texel: cone-weighted sums over the pyramid, inside one chart.
#include "lib/atlas.glsl"

// Top of the pyramid: a level-3 texel is one tile, the largest square that is sure to be of one chart.
const int kTopLevel = 3;
// A cone of radius R spans at most 2 * kRadiusInTaps + 1 taps a side at the level that is read for it.
const float kRadiusInTaps = 3.0;
const int kMaxTaps = 7 * 7;
// Radii in texels of level 0. The smallest is bilinear interpolation; the largest is what the taps reach at
// the top level: charts' tiles are the limit, wider cones would need a pyramid for each chart.
const float kMinRadius = 1.0;
const float kMaxRadius = 24.0;
// What the display pass reads for one lobe: four radii and, a tap, its sums; each after a look at its tile.
const int kMaxReadsPerLobe = 2 * 4 + 2 * kMaxTaps;

// The finest level at which the cone stays within its taps.
int coneLevel(float radius) {
    return clamp(int(ceil(log2(radius / kRadiusInTaps))), 0, kTopLevel);
}

// First and last tap (xy, zw) of the cone's square at `level`.
ivec4 coneTaps(vec2 center, float radius, int level) {
    float scale = exp2(float(-level));
    float radiusTaps = min(radius * scale, kRadiusInTaps);
    return ivec4(ceil(center * scale - radiusTaps - 0.5), floor(center * scale + radiusTaps - 0.5));
}

// sum k a L, sum k w around `center` (texel coordinates of level 0) with the cone k = 1 - r / radius.
vec4 coneSum(sampler2DArray pyramid, int lobeIndex, vec2 center, float radius, uint chart) {
    int level = coneLevel(radius);
    float scale = exp2(float(-level));
    float radiusTaps = min(radius * scale, kRadiusInTaps);
    vec2 centerTaps = center * scale;
    ivec4 taps = coneTaps(center, radius, level);
    int tileShift = kTopLevel - level;

    vec4 sum = vec4(0.0);
    for (int y = taps.y; y <= taps.w; ++y) {
        for (int x = taps.x; x <= taps.z; ++x) {
            vec2 offset = vec2(float(x), float(y)) + 0.5 - centerTaps;
            float k = 1.0 - length(offset) / radiusTaps;
            if (k <= 0.0 || chartOfTile(ivec2(x >> tileShift, y >> tileShift)) != chart) continue;
            sum += k * texelFetch(pyramid, ivec3(x, y, lobeIndex), level);
        }
    }
    return sum;
}

// No mean over the light around `center` is brighter than this.
vec3 radianceBoundAround(sampler2DArray radii, int lobeIndex, vec2 center) {
    return texelFetch(radii, ivec3(ivec2(floor(center)) >> 3, lobeIndex), 0).gba;
}

// Radius chosen by radius.frag, interpolated between the tiles of the chart; 0: no light was found.
float coneRadius(sampler2DArray radii, int lobeIndex, vec2 center, uint chart) {
    vec2 tiles = center / float(kTileSize) - 0.5;
    ivec2 corner = ivec2(floor(tiles));
    vec2 t = tiles - vec2(corner);
    float sum = 0.0, weights = 0.0;
    for (int y = corner.y; y <= corner.y + 1; ++y) {
        for (int x = corner.x; x <= corner.x + 1; ++x) {
            if (chartOfTile(ivec2(x, y)) != chart) continue;
            float weight = (x == corner.x ? 1.0 - t.x : t.x) * (y == corner.y ? 1.0 - t.y : t.y) + 1e-4;
            sum += weight * texelFetch(radii, ivec3(x, y, lobeIndex), 0).r;
            weights += weight;
        }
    }
    return weights > 0.0 ? sum / weights : 0.0;
}

// sum a L, sum w of a lobe around a texel, in the cone that radius.frag chose; farther where that holds nothing.
vec4 lobeSum(sampler2DArray pyramid, sampler2DArray radii, int lobeIndex, vec2 center, uint chart) {
    float radius = max(coneRadius(radii, lobeIndex, center, chart), kMinRadius);
    for (;;) {
        vec4 sum = coneSum(pyramid, lobeIndex, center, radius, chart);
        if (sum.a > 0.0 || radius >= kMaxRadius) return sum;
        radius = kMaxRadius;
    }
}
