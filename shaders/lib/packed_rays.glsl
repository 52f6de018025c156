// A reflection ray and what it hit, between the passes that trace and that shade it.
#include "lib/octahedral.glsl"

struct TracedRay {
    int count;       // of the rays that the pixel traces, a power of two; 0: this is none
    vec3 direction;  // world, unit
    float weight;    // of the direction's sample: what the lobe reflects of the light over its density
    float pdf;       // 1/sr, at most kMaxPdf
    int triangle;    // in the order of the leaves of lib/bvh.glsl; < 0: the environment
    bool backFace;
    vec2 barycentric;
    float distance;  // metres
    vec3 position;   // world, of the hit
};

const float kMaxPdf = 6e4;

void packRay(TracedRay ray, out uvec4 hit, out uvec4 place) {
    uint triangle = ray.triangle < 0 ? 0u : uint(ray.triangle + 1) | (ray.backFace ? 0x80000000u : 0u);
    hit = uvec4(floatBitsToUint(ray.distance), triangle | (uint(ray.count) << 25), packUnorm2x16(ray.barycentric),
                packHalf2x16(vec2(ray.weight, min(ray.pdf, kMaxPdf))));
    place = uvec4(floatBitsToUint(ray.position), packSnorm2x16(octahedralFromDirection(ray.direction)));
}

TracedRay unpackRay(uvec4 hit, uvec4 place) {
    vec2 weightPdf = unpackHalf2x16(hit.w);
    return TracedRay(int((hit.y >> 25) & 63u), octahedralToDirection(unpackSnorm2x16(place.w)), weightPdf.x, weightPdf.y,
                     int(hit.y & 0x1ffffffu) - 1, (hit.y >> 31u) != 0u, unpackUnorm2x16(hit.z),
                     uintBitsToFloat(hit.x), uintBitsToFloat(place.xyz));
}
