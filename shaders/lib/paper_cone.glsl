// The paper's filter: a bilinear tap of each level of the pyramid at the pixel, together about a cone.
// source: Hensley et al. 2003, section 6.1.
#include "lib/cone.glsl"

// Inside the chart: the paper has a texture a surface, here charts lie side by side.
vec4 bilinearTap(sampler2DArray pyramid, int layer, int level, vec2 center, uint chart) {
    vec2 point = center * exp2(float(-level)) - 0.5;
    ivec2 corner = ivec2(floor(point));
    vec2 t = point - vec2(corner);
    int tileShift = kTopLevel - level;
    vec4 sum = vec4(0.0);
    for (int y = corner.y; y <= corner.y + 1; ++y) {
        for (int x = corner.x; x <= corner.x + 1; ++x) {
            if (chartOfTile(ivec2(x >> tileShift, y >> tileShift)) != chart) continue;
            float weight = (x == corner.x ? 1.0 - t.x : t.x) * (y == corner.y ? 1.0 - t.y : t.y);
            sum += weight * texelFetch(pyramid, ivec3(x, y, layer), level);
        }
    }
    return sum;
}

// Mean around `center`. A cone is a mean of discs of growing radius, a disc's part in proportion to its area and to the
// step of the radius: 8 times as much a level. Twice, because a texel here is the sum of its four children.
// twin: levels_profile in tools/figures_profile.py.
vec3 paperMean(sampler2DArray pyramid, int layer, vec2 center, uint chart) {
    vec4 sum = vec4(0.0);
    for (int level = 0; level <= kTopLevel; ++level)
        sum += exp2(float(level)) * bilinearTap(pyramid, layer, level, center, chart);
    return sum.a > 0.0 ? sum.rgb / sum.a : vec3(0.0);
}
