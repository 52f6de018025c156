// The noise of estimated irradiance is removed by a wavelet filter that stops at edges of the surface. Indirect light
// changes over a distance that is a part of that of what is around; that of area lights is blurred as far as its noise
// hides.
// source: Dammertz et al. 2010, "Edge-Avoiding A-Trous Wavelet Transform for fast Global Illumination Filtering"; the
// distance: Ward et al. 1988; the noise: Schied et al. 2017, "Spatiotemporal Variance-Guided Filtering". In the texels of
// an atlas: ours.
#include "lib/atlas.glsl"
#include "lib/brdf.glsl"
#include "lib/irradiance_estimate.glsl"
#include "lib/texel_point.glsl"

#ifdef FIRST
uniform usampler2DArray estimates;  // [indirect, area][y][x]
#else
uniform sampler2D before;           // the last pass's
#endif
uniform int source;                 // 0 indirect, 1 area lights
uniform int step;                   // texels between taps

// rgb; a: of indirect light the reach of the filter in texels, of area lights the standard error of the luminance; < 0:
// nothing is known.
layout(location = 0) out vec4 irradianceOut;

const float kNormalPower = 32.0;
const float kPlaneTexels = 1.0;   // off the texel's plane, in texels of a tap
const float kReachOverDistance = 0.5;  // of the harmonic mean distance, for one sample a texel
const float kMaxDeviations = 3.0;
const float kQuiet = 0.01;        // relative standard error of area lights that needs no filter
// Of more samples a texel the first pass needs no neighbours.
const float kManySamples = 16.0;
// Area lights: below so many samples, their variance says little.
const float kFewSamples = 4.0;

#ifdef FIRST
float countAt(ivec2 texel) {
    return unpackEstimate(texelFetch(estimates, ivec3(texel, source), 0)).count;
}

vec4 valueAt(ivec2 texel) {
    IrradianceEstimate e = unpackEstimate(texelFetch(estimates, ivec3(texel, source), 0));
    if (e.count == 0.0) return vec4(0.0, 0.0, 0.0, -1.0);
    if (source == 0) return vec4(e.mean, kReachOverDistance * pow(e.count, -0.25) / max(e.statistic, 1e-3));
    float bright = luminance(e.mean), square = e.statistic * e.statistic;
    float variance = e.count < kFewSamples ? square : max(square - bright * bright, 0.0);
    return vec4(e.mean, sqrt(variance / e.count));
}
#else
vec4 valueAt(ivec2 texel) {
    return texelFetch(before, texel, 0);
}
#endif

// How alike the light is expected to be, `texels` apart: indirect light within its reach; that of area lights as far as a
// mean must reach to be good enough, where it differs by no more than noise.
float likeness(vec4 center, vec4 there, float texels) {
    if (source == 0) {
        float off = texels / min(center.a, there.a);
        return exp(-off * off);
    }
    float bright = luminance(center.rgb), noise = center.a * center.a + there.a * there.a;
    float off = texels * kQuiet * bright / max(center.a, 1e-6 * bright + 1e-12);
    float edge = luminance(there.rgb) - bright;
    return exp(-off * off - edge * edge / (kMaxDeviations * kMaxDeviations * noise + 1e-12));
}

void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy);
    irradianceOut = vec4(0.0, 0.0, 0.0, -1.0);
    ivec2 tile = texel >> 3;
    uint chart = chartOfTile(tile);
    if (chart == kNoChart) return;
    const float kKernel[3] = float[3](0.375, 0.25, 0.0625);
    float texelMeters = texelSizeOfTile(tile);
    vec4 center = valueAt(texel);
    TexelPoint point = texelPointAt(texel);
    // Gutters have what the first pass finds beside them: wider steps would bring light from far away to the edges.
    bool known = center.a >= 0.0;
#ifdef FIRST
    float many = max(countAt(texel) / kManySamples, 1.0), share = 1.0 / (many * many);
#endif
    vec3 sum = vec3(0.0);
    float weights = 0.0, statistic = 0.0;
    for (int i = 0; i < 25; ++i) {
        ivec2 tap = ivec2(i % 5, i / 5) - 2, other = texel + step * tap;
        if (chartAt(other) != chart) continue;
        vec4 value = valueAt(other);
        if (value.a < 0.0) continue;
        float weight = kKernel[abs(tap.x)] * kKernel[abs(tap.y)];
        if (known && i != 12) {
            TexelPoint there = texelPointAt(other);
            if (!there.receives) continue;
            float off = abs(dot(there.position - point.position, point.normal)) / (kPlaneTexels * texelMeters * float(step));
            weight *= pow(max(dot(point.normal, there.normal), 0.0), kNormalPower) * exp(-off);
#ifdef FIRST
            weight *= share;
#else
            weight *= likeness(center, value, float(step) * length(vec2(tap)));
#endif
        }
        sum += weight * value.rgb;
        weights += weight;
        // The harmonic mean of reaches; the error of a mean.
        statistic += source == 0 ? weight / max(value.a, 1e-3) : weight * weight * value.a * value.a;
    }
    if (weights <= 0.0) return;
    irradianceOut = vec4(sum / weights, source == 0 ? weights / statistic : sqrt(statistic) / weights);
}
