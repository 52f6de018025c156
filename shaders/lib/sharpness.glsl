// The angular resolution of the PHATexels around a texel.
#include "lib/lookup_tables.glsl"

// Radians: beyond, the sample is of another surface, however large parallax is.
const float kMaxParallax = 0.35;
const float kUniformCellAngle = 1.02;  // of a group's single cell: its spread, in radians

// The size of a group, 2^bits texels a side: the largest whose parallax, of a surface at distance `d`, does not
// outweigh the size of its cells.
int groupBits(float texelMeters, float d) {
    return int(clamp(floor(0.5 * log2(3.6 * d / texelMeters)), 2.0, float(kBlockBits)));
}

// Radians, of a cell where directions are uniformly distributed.
float cellAngle(int bits) {
    return kUniformCellAngle / float(1 << bits);
}

// Radians between directions to a point at distance `d` from all over a group.
float parallaxAngle(float texelMeters, float d, int bits) {
    return min(0.408 * float(1 << bits) * texelMeters / d, kMaxParallax);
}
