// Adds to a lobe's light that of its neighbours' rays, along the rows, then along the columns; then once more, of those
// farther away. source: Dammertz et al. 2010, "Edge-Avoiding A-Trous Wavelet Transform".
#include "lib/pooled_light.glsl"
#include "lib/reflection_pool.glsl"
#include "lib/view_ray.glsl"

uniform usampler2D lights;  // see lib/pooled_light.glsl
uniform usampler2D guides;
uniform float originUnitMeters;
uniform ivec2 alongWhich;   // (1, 0) or (0, 1)
uniform bool isWide;        // the second time

layout(location = 0) out uvec4 lightOut;

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
    vec3 position = positionOf(mine, pixel), squeeze = squeezeOf(mine, -viewRay(vec2(pixel) + 0.5).direction);
    ivec2 last = textureSize(lights, 0) - 1, along = (isWide ? wideStep(mine.alpha) : 1) * alongWhich;
    for (int i = -kReach; i <= kReach; ++i) {
        ivec2 p = pixel + i * along;
        if (i == 0 || p != clamp(p, ivec2(0), last)) continue;
        ReflectionGuide other = unpackGuide(texelFetch(guides, p, 0));
        float weight = float(kReach + 1 - abs(i)) * likeness(mine, other, positionOf(other, p) - position, squeeze);
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
    lightOut = packPooledLight(light);
}
