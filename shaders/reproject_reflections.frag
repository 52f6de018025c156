// Adds to a lobe's light that of the last frame, for display.frag and for the next frame. Where the light comes from was
// seen through the surface as through a window, so that is the point that is looked for in the last frame; what was there
// counts as a neighbour's rays do. source: ours; the point behind a mirror: Stachowiak 2015, "Stochastic Screen-Space
// Reflections"; the clamp: Karis 2014, "High Quality Temporal Supersampling".
#include "lib/pooled_light.glsl"
#include "lib/reflection_pool.glsl"
#include "lib/view_ray.glsl"

uniform usampler2D lights;        // see lib/pooled_light.glsl
uniform usampler2D guides;
uniform usampler2D reflectances;  // see lib/lobe_pixels.glsl
uniform usampler2D lastLights;
uniform usampler2D lastGuides;
uniform mat4 lastClipFromWorld;
uniform mat4 lastWorldFromClip;
uniform vec3 lastEye;             // as eyeWorld
uniform bool follows;             // whether there is a last frame
uniform float originUnitMeters;
uniform int lobe;

layout(location = 0) out uvec4 indirectOut;  // bits of the radiance, and of the weight of rays against the lookup
layout(location = 1) out uvec4 areaOut;
layout(location = 2) out uvec4 lightOut;     // for the next frame

// Frames whose rays count at most, beside this one's.
const float kMaxFrames = 8.0;
// Of the range of the light around, by which the last frame's may exceed it.
const float kMargin = 0.25;

struct LightRange {
    vec3 lowIndirect, highIndirect, lowArea, highArea;
};

void include(inout LightRange range, PooledLight light) {
    range.lowIndirect = min(range.lowIndirect, light.indirect);
    range.highIndirect = max(range.highIndirect, light.indirect);
    range.lowArea = min(range.lowArea, light.area);
    range.highArea = max(range.highArea, light.area);
}

vec3 clampTo(vec3 light, vec3 low, vec3 high) {
    vec3 margin = kMargin * high;
    return clamp(light, low - margin, high + margin);
}

// Of this frame, beside the pixel; neighbours whose rays were not pooled with the pixel's all.
LightRange rangeAround(ivec2 pixel, ReflectionGuide mine, PooledLight light) {
    LightRange range = LightRange(light.indirect, light.indirect, light.area, light.area);
    ivec2 last = textureSize(lights, 0) - 1;
    for (int i = 0; i < 4; ++i) {
        ivec2 p = pixel + (kReach - 1) * wideStep(mine.alpha) * ivec2(i == 0 ? 1 : i == 1 ? -1 : 0, i == 2 ? 1 : i == 3 ? -1 : 0);
        p = clamp(p, ivec2(0), last);
        if ((texelFetch(guides, p, 0).z & 0xffffffu) != mine.surface) continue;
        PooledLight there = unpackPooledLight(texelFetch(lights, p, 0));
        if (there.weight > 0.0) include(range, there);
    }
    return range;
}

// The mean light of the last frame at `place`, in pixels, as far as its lobes are like `mine`.
PooledLight lastLight(vec2 place, ReflectionGuide mine, vec3 position, vec3 squeeze) {
    PooledLight sum = PooledLight(vec3(0.0), vec3(0.0), 0.0, 0.0);
    ivec2 corner = ivec2(floor(place - 0.5)), last = textureSize(lastLights, 0) - 1;
    vec2 t = place - 0.5 - vec2(corner);
    float shares = 0.0;
    for (int i = 0; i < 4; ++i) {
        ivec2 side = ivec2(i & 1, i >> 1), p = corner + side;
        if (p != clamp(p, ivec2(0), last)) continue;
        ReflectionGuide other = unpackGuide(texelFetch(lastGuides, p, 0));
        if (other.surface != mine.surface) continue;
        ViewRay view = viewRayOf(lastWorldFromClip, lastEye, vec2(p) + 0.5);
        vec3 there = view.origin + view.direction * (other.eyeDistance * originUnitMeters);
        float share = (side.x == 1 ? t.x : 1.0 - t.x) * (side.y == 1 ? t.y : 1.0 - t.y) *
                      likeness(mine, other, (there - position) / originUnitMeters, squeeze);
        if (share <= 0.0) continue;
        PooledLight light = unpackPooledLight(texelFetch(lastLights, p, 0));
        float weight = share * light.weight;
        sum.indirect += weight * light.indirect;
        sum.area += weight * light.area;
        sum.nearness += weight * light.nearness;
        sum.weight += weight;
        shares += share;
    }
    if (sum.weight <= 0.0) return sum;
    sum.indirect /= sum.weight;
    sum.area /= sum.weight;
    sum.nearness /= sum.weight;
    return sum;
}

PooledLight withLast(ivec2 pixel, ReflectionGuide mine, PooledLight light) {
    ViewRay view = viewRay(vec2(pixel) + 0.5);
    vec3 position = view.origin + view.direction * (mine.eyeDistance * originUnitMeters);
    vec3 behind = position + view.direction / max(light.nearness, 1e-6);
    vec4 clip = lastClipFromWorld * vec4(behind, 1.0);
    if (clip.w <= 0.0) return light;
    vec2 place = (0.5 * clip.xy / clip.w + 0.5) * viewport;
    PooledLight before = lastLight(place, mine, position, squeezeOf(mine, -view.direction));
    if (before.weight <= 0.0) return light;
    LightRange range = rangeAround(pixel, mine, light);
    before.indirect = clampTo(before.indirect, range.lowIndirect, range.highIndirect);
    before.area = clampTo(before.area, range.lowArea, range.highArea);
    float weight = min(before.weight, kMaxFrames * light.weight), all = light.weight + weight;
    return PooledLight((light.weight * light.indirect + weight * before.indirect) / all,
                       (light.weight * light.area + weight * before.area) / all, all,
                       (light.weight * light.nearness + weight * before.nearness) / all);
}

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    ReflectionGuide mine = unpackGuide(texelFetch(guides, pixel, 0));
    PooledLight light = unpackPooledLight(texelFetch(lights, pixel, 0));
    if (mine.surface == 0u) light.weight = 0.0;
    if (follows && light.weight > 0.0) light = withLast(pixel, mine, light);
    uvec4 bits = texelFetch(reflectances, pixel, 0);
    float weight = light.weight > 0.0 ? unpackHalf2x16(lobe == 1 ? bits.w : bits.z).x : 0.0;
    indirectOut = floatBitsToUint(vec4(light.indirect, weight));
    areaOut = floatBitsToUint(vec4(light.area, weight));
    lightOut = packPooledLight(light);
}
