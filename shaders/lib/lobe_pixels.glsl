// What lobes.frag left of a pixel, for the passes that need no material.
#include "lib/frame.glsl"

uniform usampler2D reflectances;  // halves: F0 without colour and F90; the surface; halves: TracedLobe of base and coat
uniform sampler2D baseLobes;      // world normal, alpha
#ifdef CLEARCOAT
uniform sampler2D coatLobes;      // the same; alpha 0: none
#endif

const int kBaseLobe = 0;
const int kCoatLobe = 1;
const float kCoatF0 = 0.04;

struct PixelLobe {
    vec3 normal;
    float alpha;     // 0: none
    float f0;        // without colour
    float f90;
    uint surface;    // twice the surface's number, and 1 for its front, 2 for its back; 0: nothing is there
    float weight;    // of rays against the lookup, see lib/traced_weight.glsl
    float distance;  // units of length, to the nearest surface around the mirror direction
};

PixelLobe pixelLobe(ivec2 pixel, int lobe) {
    uvec4 bits = texelFetch(reflectances, pixel, 0);
    vec2 traced = unpackHalf2x16(lobe == kCoatLobe ? bits.w : bits.z);
#ifdef CLEARCOAT
    if (lobe == kCoatLobe) {
        vec4 coat = texelFetch(coatLobes, pixel, 0);
        return PixelLobe(coat.xyz, coat.a, kCoatF0, 1.0, bits.y, traced.x, traced.y);
    }
#endif
    vec4 base = texelFetch(baseLobes, pixel, 0);
    vec2 reflectance = unpackHalf2x16(bits.x);
    return PixelLobe(base.xyz, base.a, reflectance.x, reflectance.y, bits.y, traced.x, traced.y);
}
