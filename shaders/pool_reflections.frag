// Adds to a lobe's light that of its neighbours' rays, along the rows, then along the columns; the second time for
// display.frag.
#include "lib/pooled_light.glsl"
#include "lib/reflection_pool.glsl"
#include "lib/view_ray.glsl"

uniform usampler2D lights;  // see lib/pooled_light.glsl
uniform usampler2D guides;
uniform float originUnitMeters;
uniform ivec2 alongWhich;   // (1, 0) or (0, 1)
#ifdef FINAL
uniform usampler2D reflectances;  // see lib/lobe_pixels.glsl
uniform int lobe;

layout(location = 0) out uvec4 indirectOut;  // bits of the radiance, and of the weight of rays against the lookup
layout(location = 1) out uvec4 areaOut;
#else
layout(location = 0) out uvec4 lightOut;
#endif

vec3 positionOf(ReflectionGuide g, ivec2 pixel) {
    ViewRay view = viewRay(vec2(pixel) + 0.5);
    return view.origin / originUnitMeters + view.direction * g.eyeDistance;
}

PooledLight pooledLight(ivec2 pixel, ReflectionGuide mine) {
    PooledLight sum = unpackPooledLight(texelFetch(lights, pixel, 0));
    float weights = float(kReach + 1) * sum.weight;
    sum.indirect *= weights;
    sum.area *= weights;
    sum.nearness *= weights;
    vec3 position = positionOf(mine, pixel);
    ivec2 last = textureSize(lights, 0) - 1;
    for (int i = -kReach; i <= kReach; ++i) {
        ivec2 p = pixel + i * alongWhich;
        if (i == 0 || p != clamp(p, ivec2(0), last)) continue;
        ReflectionGuide other = unpackGuide(texelFetch(guides, p, 0));
        float weight = float(kReach + 1 - abs(i)) * likeness(mine, other, positionOf(other, p) - position);
        if (weight <= 0.0) continue;
        PooledLight light = unpackPooledLight(texelFetch(lights, p, 0));
        weight *= light.weight;
        sum.indirect += weight * light.indirect;
        sum.area += weight * light.area;
        sum.nearness += weight * light.nearness;
        weights += weight;
    }
    if (weights <= 0.0) return PooledLight(vec3(0.0), vec3(0.0), 0.0, 0.0);
    sum.indirect /= weights;
    sum.area /= weights;
    sum.nearness /= weights;
    sum.weight = weights;
    return sum;
}

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    ReflectionGuide mine = unpackGuide(texelFetch(guides, pixel, 0));
    PooledLight light = PooledLight(vec3(0.0), vec3(0.0), 0.0, 0.0);
    if (mine.surface != 0u) light = pooledLight(pixel, mine);
#ifdef FINAL
    uvec4 bits = texelFetch(reflectances, pixel, 0);
    float weight = light.weight > 0.0 ? unpackHalf2x16(lobe == 1 ? bits.w : bits.z).x : 0.0;
    indirectOut = floatBitsToUint(vec4(light.indirect, weight));
    areaOut = floatBitsToUint(vec4(light.area, weight));
#else
    lightOut = packPooledLight(light);
#endif
}
