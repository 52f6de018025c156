// PHATexels as they are stored, and the guides' densities.
// twin: src/core/phatexel/phatexture.h, same names; tests/gl compares the two.
#include "lib/hemisphere_map.glsl"
#include "lib/octahedral.glsl"

const int kGuideSize = 16;
const float kFarDistance = 1e30;
const int kOctahedralMax = 4095;

uniform float unitMeters;  // Atlas::unitMeters: lengths in this and other files are multiples of it

struct Phatexel {
    vec3 radiance;        // W/(m2 sr), arriving
    vec3 directionBlock;  // unit, in the block's frame
    float distance;       // metres; kFarDistance: infinity
    float pdf;            // 1/sr
    bool valid;
};

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

vec3 unpackRgb9e5(uint bits) {
    float scale = exp2(float(int(bits >> 27) - 15 - 9));
    return vec3(float(bits & 511u), float((bits >> 9) & 511u), float((bits >> 18) & 511u)) * scale;
}

uint packOctahedral24(vec3 d) {
    uvec2 code = uvec2(clamp(octahedralFromDirection(d) * 0.5 + 0.5, 0.0, 1.0) * float(kOctahedralMax) + 0.5);
    return code.x | (code.y << 12);
}

vec3 unpackOctahedral24(uint bits) {
    vec2 code = vec2(float(bits & 4095u), float((bits >> 12) & 4095u));
    return octahedralToDirection(code * (2.0 / float(kOctahedralMax)) - 1.0);
}

const float kCodesPerOctave = 253.0 / 19.931569;

uint packDistance(float meters) {
    if (meters >= kFarDistance) return 255u;
    float nearest = 1e-3 * unitMeters;
    float code = log2(max(meters, nearest) / nearest) * kCodesPerOctave;
    return uint(clamp(floor(code + 0.5), 0.0, 253.0)) + 1u;
}

float unpackDistance(uint code) {
    if (code == 255u) return kFarDistance;
    return 1e-3 * unitMeters * exp2(float(int(code) - 1) / kCodesPerOctave);
}

// The pdf is not in the bytes and stays 0 here.
Phatexel unpackPhatexel(uvec2 bits) {
    Phatexel phatexel = Phatexel(vec3(0.0), vec3(0.0, 0.0, 1.0), 0.0, 0.0, false);
    uint distanceCode = bits.y >> 24;
    if (distanceCode == 0u) return phatexel;
    phatexel.radiance = unpackRgb9e5(bits.x);
    phatexel.directionBlock = unpackOctahedral24(bits.y & 0xffffffu);
    // A direction at the very horizon may come back a hair below it.
    phatexel.directionBlock.z = max(phatexel.directionBlock.z, 0.0);
    phatexel.distance = unpackDistance(distanceCode);
    phatexel.valid = true;
    return phatexel;
}

// The cell of a guide; `direction` in the block's frame.
ivec2 guideCell(vec3 direction) {
    return clamp(ivec2(hemisphereToSquare(direction) * float(kGuideSize)), 0, kGuideSize - 1);
}

// `guidePdf` holds a tile of 16x16 cell densities (1/sr) for each block, row by row.
float squareToGuidePdf(sampler2D guidePdf, int block, vec3 direction) {
    if (direction.z < 0.0) return 0.0;
    int blocksWide = textureSize(guidePdf, 0).x / kGuideSize;
    ivec2 tile = ivec2(block % blocksWide, block / blocksWide) * kGuideSize;
    return texelFetch(guidePdf, tile + guideCell(direction), 0).r;
}
