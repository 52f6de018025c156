// The sums over a pixel's samples of one lobe, as they are stored between the passes of the lookup.
#include "lib/fetch.glsl"
#include "lib/phatexel.glsl"

struct LobeSums {
    vec4 indirect;  // sum g L, sum g
    float cosine;   // the sum of g times the mean luminance of indirect light under the cosine, see IncidentSums
    vec4 area;      // the same of area lights, less what `areaByLight` has
    vec4 areaByLight;
    vec3 mirror;    // world, the pixel's mirror direction
    uint surface;   // and its side; 0: nothing, below 2^24
    float alpha;    // of the lobe after the roughness clamp
};

LobeSums noLobeSums() {
    return LobeSums(vec4(0.0), 0.0, vec4(0.0), vec4(0.0), vec3(0.0, 0.0, 1.0), 0u, 0.0);
}

uvec2 packSum(vec4 sum) {
    return uvec2(packRgb9e5(sum.rgb / max(sum.a, 1e-30)), floatBitsToUint(sum.a));
}

vec4 unpackSum(uvec2 bits) {
    return uintBitsToFloat(bits.y) * vec4(unpackRgb9e5(bits.x), 1.0);
}

// The weight and the mean under the cosine are halves.
uvec2 packIndirectSums(LobeSums d) {
    float weight = max(d.indirect.a, 1e-30);
    vec2 halves = min(vec2(d.indirect.a, d.cosine / weight), 65504.0);
    return uvec2(packRgb9e5(d.indirect.rgb / weight), packHalf2x16(halves));
}

void unpackIndirectSums(uvec2 bits, inout LobeSums d) {
    vec2 halves = unpackHalf2x16(bits.y);
    d.indirect = halves.x * vec4(unpackRgb9e5(bits.x), 1.0);
    d.cosine = halves.x * halves.y;
}

// Area lights have a texel of their own: packAreaSums.
uvec4 packLobeSums(LobeSums d) {
    return uvec4(packIndirectSums(d), packSnorm2x16(octahedralFromDirection(d.mirror)),
                 d.surface | (uint(sqrt(clamp(d.alpha, 0.0, 1.0)) * 255.0 + 0.5) << 24));
}

LobeSums unpackLobeSums(uvec4 bits) {
    float root = float(bits.w >> 24) / 255.0;
    LobeSums d = noLobeSums();
    unpackIndirectSums(bits.xy, d);
    d.mirror = octahedralToDirection(unpackSnorm2x16(bits.z));
    d.surface = bits.w & 0xffffffu;
    d.alpha = root * root;
    return d;
}

uvec4 packAreaSums(LobeSums d) {
    return uvec4(packSum(d.area), packSum(d.areaByLight));
}

void unpackAreaSums(uvec4 bits, inout LobeSums d) {
    d.area = unpackSum(bits.xy);
    d.areaByLight = unpackSum(bits.zw);
}
