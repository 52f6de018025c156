// How sharp a picture of their surroundings the PHATexels around a place hold.
#include "lib/lookup_tables.glsl"

// Radians: beyond, what is close is another thing, however large parallax is.
const float kMostParallax = 0.35;
const float kUniformCellAngle = 1.02;  // of a group's single cell: its spread, in radians

// A group of 2^bits texels a side is small enough that its own parallax, of what is `d` away, does not outweigh its
// cells' size.
int groupBits(float texelMeters, float d) {
    return int(clamp(floor(0.5 * log2(3.6 * d / texelMeters)), 2.0, float(kBlockBits)));
}

// Radians, of a cell where directions are drawn evenly.
float cellAngle(int bits) {
    return kUniformCellAngle / float(1 << bits);
}

// Radians between directions to what is `d` away, from all over a group.
float parallaxAngle(float texelMeters, float d, int bits) {
    return min(0.408 * float(1 << bits) * texelMeters / d, kMostParallax);
}
