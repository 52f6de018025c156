// The sums over a pixel's samples of one lobe, as they are stored between the passes of the lookup.
#include "lib/fetch.glsl"
#include "lib/phatexel.glsl"

struct LobeSums {
    vec4 indirect;  // sum g L, sum g
    vec4 area;      // the same of area lights, less what `areaByLight` has
    vec4 areaByLight;
    vec3 mirror;    // world, the pixel's mirror direction
    uint surface;   // and its side; 0: nothing, below 2^24
    float alpha;    // of the lobe after the roughness clamp
};

LobeSums noLobeSums() {
    return LobeSums(vec4(0.0), vec4(0.0), vec4(0.0), vec3(0.0, 0.0, 1.0), 0u, 0.0);
}

uvec2 packSum(vec4 sum) {
    return uvec2(packRgb9e5(sum.rgb / max(sum.a, 1e-30)), floatBitsToUint(sum.a));
}

vec4 unpackSum(uvec2 bits) {
    return uintBitsToFloat(bits.y) * vec4(unpackRgb9e5(bits.x), 1.0);
}

// Area lights have a texel of their own: packAreaSums.
uvec4 packLobeSums(LobeSums d) {
    return uvec4(packSum(d.indirect), packSnorm2x16(octahedralFromDirection(d.mirror)),
                 d.surface | (uint(sqrt(clamp(d.alpha, 0.0, 1.0)) * 255.0 + 0.5) << 24));
}

LobeSums unpackLobeSums(uvec4 bits) {
    float root = float(bits.w >> 24) / 255.0;
    vec3 mirror = octahedralToDirection(unpackSnorm2x16(bits.z));
    return LobeSums(unpackSum(bits.xy), vec4(0.0), vec4(0.0), mirror, bits.w & 0xffffffu, root * root);
}

uvec4 packAreaSums(LobeSums d) {
    return uvec4(packSum(d.area), packSum(d.areaByLight));
}

void unpackAreaSums(uvec4 bits, inout LobeSums d) {
    d.area = unpackSum(bits.xy);
    d.areaByLight = unpackSum(bits.zw);
}
