// The mean of what a pixel's own rays brought.
#include "lib/pooled_light.glsl"

uniform sampler2D indirectSums;  // see shade_reflections.frag
uniform sampler2D areaSums;
uniform vec3 brightest;

layout(location = 0) out uvec4 lightOut;

// Less would dim lines of a pixel's width, and lamps that single rays of rough lobes meet.
const float kMaxOverNeighbors = 16.0;
const float kLargest = 65408.0;  // that packPooledLight holds

float luminance(vec3 rgb) {
    return dot(rgb, vec3(0.2126, 0.7152, 0.0722));
}

// Rays that reach an emitter by way of two sharp lobes are rare and bright. A clamp of what exceeds those around; where
// these brought nothing, the few rays of a lobe's tail are all the light that there is.
float kept(ivec2 pixel, vec4 own) {
    ivec2 last = textureSize(indirectSums, 0) - 1;
    vec4 around = vec4(0.0);
    for (int i = 0; i < 4; ++i) {
        ivec2 p = pixel + 2 * ivec2(i == 0 ? 1 : i == 1 ? -1 : 0, i == 2 ? 1 : i == 3 ? -1 : 0);
        around += texelFetch(indirectSums, clamp(p, ivec2(0), last), 0);
    }
    float most = kMaxOverNeighbors * luminance(around.rgb) / max(around.a, 1e-20);
    if (most == 0.0) return 1.0;
    return min(1.0, most / max(luminance(own.rgb) / own.a, 1e-20));
}

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    vec4 indirect = texelFetch(indirectSums, pixel, 0), area = texelFetch(areaSums, pixel, 0);
    lightOut = uvec4(0u);
    if (indirect.a <= 0.0) return;
    // The sums are halves, which are infinite where rays found the sun.
    vec3 meanArea = min(area.rgb / indirect.a, min(brightest, vec3(kLargest)));
    PooledLight light =
        PooledLight(kept(pixel, indirect) * indirect.rgb / indirect.a, meanArea, indirect.a, area.a / indirect.a);
    // A clamp: the two are independent estimates, whose noise must not exceed all light that there is.
    vec3 scale = min(vec3(1.0), brightest / max(light.indirect + light.area, vec3(1e-20)));
    light.indirect *= scale;
    light.area *= scale;
    lightOut = packPooledLight(light);
}
