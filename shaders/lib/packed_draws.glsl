// What a pixel's draws saw, in one texel between the passes of the lookup.
#include "lib/fetch.glsl"
#include "lib/phatexel.glsl"

struct Draws {
    vec3 radiance;  // sum g L / sum g
    float weight;   // sum g
    vec3 mirror;    // world, the pixel's mirror direction
    uint surface;   // and its side; 0: nothing, below 2^24
    float alpha;    // of the lobe as it was drawn
};

// twin: packRgb9e5 in src/core/phatexture.h; tests/shader compares the two.
uint packRgb9e5(vec3 rgb) {
    rgb = clamp(rgb, vec3(0.0), vec3(65408.0));
    float largest = max(rgb.r, max(rgb.g, rgb.b));
    int exponent = largest > 0.0 ? max(-16, int(floor(log2(largest)))) + 16 : 0;
    float scale = exp2(float(exponent - 24));
    // Rounding up may need one bit more, and log2 may be off by one at powers of two.
    if (floor(largest / scale + 0.5) >= 512.0) {
        ++exponent;
        scale *= 2.0;
    }
    uvec3 mantissa = uvec3(floor(rgb / scale + 0.5));
    return mantissa.r | (mantissa.g << 9) | (mantissa.b << 18) | (uint(exponent) << 27);
}

vec2 directionToOctahedral(vec3 d) {
    vec2 p = d.xy / (abs(d.x) + abs(d.y) + abs(d.z));
    vec2 folded = (1.0 - abs(p.yx)) * vec2(p.x >= 0.0 ? 1.0 : -1.0, p.y >= 0.0 ? 1.0 : -1.0);
    return d.z < 0.0 ? folded : p;
}

uvec4 packDraws(Draws d) {
    return uvec4(packRgb9e5(d.radiance), floatBitsToUint(d.weight), packSnorm2x16(directionToOctahedral(d.mirror)),
                 d.surface | (uint(sqrt(clamp(d.alpha, 0.0, 1.0)) * 255.0 + 0.5) << 24));
}

Draws unpackDraws(uvec4 bits) {
    float root = float(bits.w >> 24) / 255.0;
    return Draws(unpackRgb9e5(bits.x), uintBitsToFloat(bits.y), octahedralToDirection(unpackSnorm2x16(bits.z)),
                 bits.w & 0xffffffu, root * root);
}
