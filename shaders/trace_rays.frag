// One ray for each texel of two tables. Variants: ANY_HIT, BVH_OPACITY.
#include "lib/bvh.glsl"

uniform sampler2D rayOrigins;     // w: the greatest distance; 0: no ray
uniform sampler2D rayDirections;  // unit

// Distance, triangle in the order of the leaves, counted from 1, negative where its back was hit, 0: none; barycentrics.
// With ANY_HIT: whether there is a hit.
layout(location = 0) out vec4 hitOut;

void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy);
    vec4 origin = texelFetch(rayOrigins, texel, 0);
    vec3 direction = texelFetch(rayDirections, texel, 0).xyz;
    hitOut = vec4(0.0);
    if (origin.w <= 0.0) return;
#ifdef ANY_HIT
    hitOut.x = anyHit(origin.xyz, direction, origin.w) ? 1.0 : 0.0;
#else
    BvhHit hit = closestHit(origin.xyz, direction, origin.w);
    if (hit.triangle < 0) return;
    float number = float(hit.triangle + 1);
    hitOut = vec4(hit.distance, hit.backFace ? -number : number, hit.barycentric);
#endif
}
