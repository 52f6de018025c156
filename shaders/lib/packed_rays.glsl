// A reflection ray and what it hit, between the passes that trace and that shade it.
#include "lib/hemisphere_map.glsl"
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

void packRay(TracedRay ray, out uvec4 hit, out uvec4 place) {
    uint triangle = ray.triangle < 0 ? 0u : uint(ray.triangle + 1) | (ray.backFace ? 0x80000000u : 0u);
    hit = uvec4(floatBitsToUint(ray.distance), triangle | (uint(ray.count) << 25), packUnorm2x16(ray.barycentric),
                packHalf2x16(vec2(ray.weight, min(ray.pdf, kMaxPdf))));
    place = uvec4(floatBitsToUint(ray.position), packSnorm2x16(octahedralFromDirection(ray.direction)));
}

bool hitsNothing(uvec4 hit) {
    return (hit.y & 0x1ffffffu) == 0u;
}

// Metres, where it hits something.
float hitDistance(uvec4 hit) {
    return uintBitsToFloat(hit.x);
}

TracedRay unpackRay(uvec4 hit, uvec4 place) {
    vec2 weightPdf = unpackHalf2x16(hit.w);
    return TracedRay(int((hit.y >> 25) & 63u), octahedralToDirection(unpackSnorm2x16(place.w)), weightPdf.x, weightPdf.y,
                     int(hit.y & 0x1ffffffu) - 1, (hit.y >> 31u) != 0u, unpackUnorm2x16(hit.z),
                     hitDistance(hit), uintBitsToFloat(place.xyz));
}
