// How many reflection rays each pixel traces for one of its lobes, and what its neighbours need to know to share them.
// source: ours; src/core/render/traced_reflections.cpp has the same rule for frames at rest.
#include "lib/lobe_pixels.glsl"
#include "lib/reflection_pool.glsl"
#include "lib/view_ray.glsl"

uniform usampler2D points;     // see lobes.frag
uniform float originUnitMeters;
uniform int lobe;
uniform float raysPerNeighborhood;
uniform int maxRays;           // of a pixel

const float kRaysPerAlpha = 800.0;
// Of the rays that the second pooling brings, at its widest.
const float kFromAfar = 4.0;

layout(location = 0) out uvec4 guideOut;

// The passes that follow run where this depth, of the number of rays, exceeds theirs; 0: there is no lobe.
// twin: src/gl/ray_pass.cpp.
const float kCountedRays = 64.0;

vec3 positionAt(ivec2 pixel) {
    return uintBitsToFloat(texelFetch(points, pixel, 0).xyz);
}

vec3 towardEyeAt(vec3 position) {
    return normalize(eyeWorld - position * (1.0 - eyeAtInfinity));
}

ReflectionGuide guideAt(ivec2 pixel, vec3 position) {
    PixelLobe l = pixelLobe(pixel, lobe);
    bool traced = l.weight > 0.0 && l.alpha > 0.0;
    vec3 towardEye = towardEyeAt(position);
    float eyeDistance = dot(position - viewRay(vec2(pixel) + 0.5).origin, -towardEye);
    return ReflectionGuide(reflect(-towardEye, l.normal), l.alpha, l.distance, traced ? l.surface : 0u, 0,
                           eyeDistance / originUnitMeters);
}

// How many pixels along an axis share the rays, 1 to 4: the sum of the tent times the likeness, if that falls off as it
// does to the next pixel.
float sharedAlong(ReflectionGuide mine, vec3 position, vec3 squeeze, ivec2 pixel) {
    ivec2 last = textureSize(points, 0) - 1;
    vec3 there = positionAt(min(pixel, last));
    float like = likeness(mine, guideAt(min(pixel, last), there), (there - position) / originUnitMeters, squeeze);
    float square = like * like, fourth = square * square;
    return 1.0 + 0.5 * (3.0 * like + 2.0 * fourth + fourth * fourth * like);
}

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    guideOut = uvec4(0u);
    gl_FragDepth = 0.0;
    PixelLobe l = pixelLobe(pixel, lobe);
    if (l.weight <= 0.0 || l.alpha <= 0.0 || l.surface == 0u) return;
    vec3 position = positionAt(pixel);
    ReflectionGuide mine = guideAt(pixel, position);
    vec3 squeeze = squeezeOf(mine, towardEyeAt(position));
    float sharing = sharedAlong(mine, position, squeeze, pixel + ivec2(1, 0)) *
                    sharedAlong(mine, position, squeeze, pixel + ivec2(0, 1));
    float wanted = min(raysPerNeighborhood * l.weight / sharing, kRaysPerAlpha * l.alpha);
    // A power of two, as the sequence of their random numbers asks for.
    mine.rays = clamp(int(exp2(ceil(log2(max(wanted, 1.0)) - 0.01))), 1, maxRays);
    // Where the second pooling reaches far, every other group of 4x4 pixels traces none.
    float step = float(wideStep(mine.alpha));
    if (kFromAfar * wanted < 0.5 * step * step && (((pixel.x ^ pixel.y) >> 2) & 1) != 0) mine.rays = 0;
    guideOut = packGuide(mine);
    gl_FragDepth = (float(mine.rays) + 0.25) / kCountedRays;
}
