// Which lobes the CPU traces, and which are looked up; and how near what they reflect is.
#include "lib/sharpness.glsl"

uniform bool tracesAll;
uniform int frame;  // of several whose mean is shown

// Ratios of the PHATexels' spread to the lobe's width below which a lobe is looked up, and above which it is traced;
// measured (docs/lookup.md).
const float kNoneTraced = 0.7;
const float kAllTraced = 1.5;

// Metres to the nearest surface around the mirror direction.
float nearestAround(vec3 normal, vec3 position, vec3 towardEye, vec2 texel, uint chartIndex) {
    ChartExtent chart = chartExtent(chartIndex);
    // A different one each frame.
    int rank = (4 * (int(gl_FragCoord.y) & 3) + (int(gl_FragCoord.x) & 3)) ^ (frame & 15);
    ivec2 here = texelOfRank(chart, texel, rank);
    DepthProbe probe = depthProbeAt(lookupTileAt(chart, here), here, position);
    return leastDistanceAround(probe, reflect(-towardEye, normal));
}

// x: the weight of rays against the lookup, 0 to 1; y: nearestAround().
vec2 tracedWeight(vec3 normal, float alpha, vec3 position, vec3 towardEye, vec2 texel, uint chartIndex) {
    if (alpha <= 0.0) return vec2(0.0);
    ChartExtent chart = chartExtent(chartIndex);
    // A different one each frame.
    int rank = (4 * (int(gl_FragCoord.y) & 3) + (int(gl_FragCoord.x) & 3)) ^ (frame & 15);
    ivec2 here = texelOfRank(chart, texel, rank);
    DepthProbe probe = depthProbeAt(lookupTileAt(chart, here), here, position);
    vec3 mirror = reflect(-towardEye, normal);
    // At grazing angles a lobe is narrower in one direction: its solid angle is proportional to the cosine.
    float width = alpha * sqrt(max(dot(normal, towardEye), 0.01));
    float nearest = kHorizon * unitMeters, weight = 0.0;
    for (int i = 0; i < 9; ++i) {
        float d = distanceAlong(probe, mirror, vec2(i % 3 - 1, i / 3 - 1));
        int bits = groupBits(chart.texelMeters, d);
        vec2 spread = vec2(cellAngle(bits), parallaxAngle(chart.texelMeters, d, bits));
        weight += smoothstep(kNoneTraced, kAllTraced, length(spread) / width) / 9.0;
        nearest = min(nearest, d);
    }
    // Half of the cells around are enough for all of the weight, so that it grows gradually toward close surfaces.
    return vec2(tracesAll ? 1.0 : min(2.0 * weight, 1.0), nearest);
}
