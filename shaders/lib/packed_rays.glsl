// A reflection ray and what it hit, between the passes that trace and that shade it.
#include "lib/hemisphere_map.glsl"
#include "lib/octahedral.glsl"

struct TracedRay {
    int count;       // of the rays that the pixel traces, a power of two; 0: this is none
    vec3 direction;  // world, unit
    vec3 tint;       // what glass on its way leaves of the light
    float weight;    // of the direction's sample, 0 to 1: what the lobe reflects of the light over its density
    float pdf;       // 1/sr, at most kMaxPdf
    int triangle;    // in the order of the leaves of lib/bvh.glsl; < 0: the environment
    bool backFace;
    vec2 barycentric;
    float distance;  // metres, of the whole way
    vec3 position;   // world, of the hit
};
// Behind glass `direction` is the one that it arrives by.

const float kMaxPdf = 6e4;
// Angle of the cone that a ray of a rough lobe stands for, over alpha: rays are neighbours' rays, too.
const float kSpreadPerAlpha = 0.25;

// About the alpha of the lobe that the ray was drawn from: a GGX lobe's density at its peak is 1 / (4 pi alpha^2).
float rayAlpha(TracedRay ray) {
    return inversesqrt(4.0 * kPi * max(ray.pdf, 0.1));
}

// Metres across what the ray stands for at its hit. `spread`: radians, of a mirror's.
float rayWidth(TracedRay ray, float spread) {
    return (spread + kSpreadPerAlpha * rayAlpha(ray)) * ray.distance;
}

// In 16 bits: 2^-32 to 2^32 metres by steps of .07 %.
uint packLength(float meters) {
    return uint(clamp(1024.0 * (log2(max(meters, 1e-30)) + 32.0) + 0.5, 0.0, 65535.0));
}

float unpackLength(uint code) {
    return exp2(float(code) / 1024.0 - 32.0);
}

// 8 bits each, of their square roots: a weight that is left is not 0.
uint packTint(vec3 tint, float weight) {
    uvec4 code = uvec4(255.0 * sqrt(clamp(vec4(tint, weight), 0.0, 1.0)) + 0.5);
    if (weight > 0.0) code.w = max(code.w, 1u);
    return code.x | (code.y << 8) | (code.z << 16) | (code.w << 24);
}

vec4 unpackTint(uint bits) {
    vec4 root = vec4(bits & 255u, (bits >> 8) & 255u, (bits >> 16) & 255u, bits >> 24) / 255.0;
    return root * root;
}

void packRay(TracedRay ray, out uvec4 hit, out uvec4 place) {
    uint triangle = ray.triangle < 0 ? 0u : uint(ray.triangle + 1) | (ray.backFace ? 0x80000000u : 0u);
    hit = uvec4(packLength(ray.distance) | (packHalf2x16(vec2(min(ray.pdf, kMaxPdf), 0.0)) << 16),
                triangle | (uint(ray.count) << 25), packUnorm2x16(ray.barycentric), packTint(ray.tint, ray.weight));
    place = uvec4(floatBitsToUint(ray.position), packSnorm2x16(octahedralFromDirection(ray.direction)));
}

bool hitsNothing(uvec4 hit) {
    return (hit.y & 0x1ffffffu) == 0u;
}

// Metres, where it hits something.
float hitDistance(uvec4 hit) {
    return unpackLength(hit.x & 0xffffu);
}

TracedRay unpackRay(uvec4 hit, uvec4 place) {
    vec4 tint = unpackTint(hit.w);
    return TracedRay(int((hit.y >> 25) & 63u), octahedralToDirection(unpackSnorm2x16(place.w)), tint.rgb, tint.a,
                     unpackHalf2x16(hit.x).y, int(hit.y & 0x1ffffffu) - 1, (hit.y >> 31u) != 0u, unpackUnorm2x16(hit.z),
                     hitDistance(hit), uintBitsToFloat(place.xyz));
}
