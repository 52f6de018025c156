// What the passes of traced reflections need to know of a pixel's lobe, in one texel.
#include "lib/octahedral.glsl"

struct ReflectionGuide {
    vec3 mirror;     // world, unit: the direction toward the eye, reflected
    float alpha;
    float distance;  // units of length, to the nearest surface around `mirror`
    uint surface;    // as PixelLobe's; 0: the lobe is not traced
    int rays;        // that the pixel traces
    float eyeDistance;  // units of length, along the view ray
};

uvec4 packGuide(ReflectionGuide g) {
    return uvec4(packSnorm2x16(octahedralFromDirection(g.mirror)), packHalf2x16(vec2(g.alpha, g.distance)),
                 g.surface | (uint(g.rays) << 24), floatBitsToUint(g.eyeDistance));
}

ReflectionGuide unpackGuide(uvec4 bits) {
    vec2 alphaDistance = unpackHalf2x16(bits.y);
    return ReflectionGuide(octahedralToDirection(unpackSnorm2x16(bits.x)), alphaDistance.x, alphaDistance.y,
                           bits.z & 0xffffffu, int(bits.z >> 24), uintBitsToFloat(bits.w));
}
