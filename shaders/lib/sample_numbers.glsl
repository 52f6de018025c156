// Low-discrepancy numbers: Sobol's points, of which the pixels of a group of 4x4 have different ones.
// twin: src/gl/sample_numbers.cpp, web/src/sample_numbers.js.

const int kMaxSamples = 32;
const int kRanks = 16;
const int kPlaces = 13;  // bits of kMaxSamples * kRanks * kRanks

uniform uvec4 sampleNumbers[kMaxSamples];  // fractions of 2^32, the same for all pixels but for `ranks`
uniform uvec4 ranks[kRanks];
uniform uvec4 placeNumbers[kPlaces];        // of the sequence's points 1, 2, 4, 8 ...

// Of a pixel in its group.
int rankOf(ivec2 pixel) {
    ivec2 inGroup = pixel & 3;
    return 4 * inGroup.y + inGroup.x;
}

// Bayer's order of a group's pixels, 0 to 15: neighbours are far apart.
int bayerOrder(ivec2 p) {
    int x = p.x & 3, y = p.y & 3;
    return ((((x ^ y) & 1) * 2 + (y & 1)) * 4) + (((x ^ y) >> 1) & 1) * 2 + ((y >> 1) & 1);
}

// Of pixels that take different numbers of samples: `count`, a power of two up to kMaxSamples. A group's pixels with the
// same count have an aligned run together, and so do the groups of 16x16 pixels: those that pool take other numbers
// than their neighbours.
vec4 sampleNumbersOf(int k, ivec2 pixel, int count) {
    int order = bayerOrder(pixel) + kRanks * bayerOrder(pixel >> 2);
    uvec4 bits = sampleNumbers[k];
    for (int place = order * count, i = 0; place > 0; place >>= 1, ++i)
        if ((place & 1) != 0) bits ^= placeNumbers[i];
    return vec4(bits >> 8) * exp2(-24.0);
}

// The four numbers in [0,1) of sample `k` of a pixel.
vec4 sampleNumbersOf(int k, int rank) {
    return vec4((sampleNumbers[k] ^ ranks[rank]) >> 8) * exp2(-24.0);
}
