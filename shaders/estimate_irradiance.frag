// Adds one sample to the estimates of the irradiance of some blocks' texels.
#include "lib/atlas.glsl"
#include "lib/brdf.glsl"
#include "lib/irradiance_estimate.glsl"
#include "lib/packed_rays.glsl"
#include "lib/texel_batch.glsl"
#include "lib/texel_point.glsl"

uniform usampler2D hits;            // see lib/packed_rays.glsl
uniform sampler2D indirectLight;    // over pi
uniform sampler2D areaLight;
uniform usampler2DArray estimates;  // [indirect, area][y][x] of the atlas

layout(location = 0) out uvec4 indirectOut;
layout(location = 1) out uvec4 areaOut;

// The size of a texel over the distance of what the ray meets; 0: that is nothing.
float nearness(ivec2 pixel, ivec2 texel) {
    uvec4 hit = texelFetch(hits, pixel, 0);
    if (hitsNothing(hit)) return 0.0;
    float meters = texelSizeOfTile(texel >> 3);
    return meters / max(hitDistance(hit), 0.1 * meters);
}

void add(inout IrradianceEstimate e, float maxSamples, vec3 light) {
    e.count = min(e.count, maxSamples) + 1.0;
    e.mean = mix(e.mean, light, 1.0 / e.count);
}

void main() {
    indirectOut = areaOut = uvec4(0u);
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    BatchTexel t = batchTexelAt(pixel);
    if (!t.valid || !texelPointAt(t.texel).receives) return;
    IrradianceEstimate indirect = unpackEstimate(texelFetch(estimates, ivec3(t.texel, 0), 0));
    add(indirect, t.block.maxSamples, kPi * texelFetch(indirectLight, pixel, 0).rgb);
    indirect.statistic = mix(indirect.statistic, nearness(pixel, t.texel), 1.0 / indirect.count);
    indirectOut = packEstimate(indirect);

    IrradianceEstimate area = unpackEstimate(texelFetch(estimates, ivec3(t.texel, 1), 0));
    vec3 light = kPi * texelFetch(areaLight, pixel, 0).rgb;
    add(area, t.block.maxSamples, light);
    float bright = luminance(light), square = area.statistic * area.statistic;
    area.statistic = sqrt(mix(square, bright * bright, 1.0 / area.count));
    areaOut = packEstimate(area);
}
