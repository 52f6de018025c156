// Low-discrepancy numbers: Sobol's points, of which the pixels of a group of 4x4 have different ones.
// twin: src/gl/sample_numbers.cpp, web/src/sample_numbers.js.

const int kMaxSamples = 32;
const int kRanks = 16;
const int kPlaces = 9;  // bits of kMaxSamples * kRanks

uniform uvec4 sampleNumbers[kMaxSamples];  // fractions of 2^32, the same for all pixels but for `ranks`
uniform uvec4 ranks[kRanks];
uniform uvec4 placeNumbers[kPlaces];        // of the sequence's points 1, 2, 4, 8 ...

// Of a pixel in its group.
int rankOf(ivec2 pixel) {
    ivec2 inGroup = pixel & 3;
    return 4 * inGroup.y + inGroup.x;
}

// Of pixels that take different numbers of samples: `count`, a power of two up to kMaxSamples. A group's pixels with the
// same count have an aligned run together.
vec4 sampleNumbersOf(int k, ivec2 pixel, int count) {
    int x = pixel.x & 3, y = pixel.y & 3;
    // Bayer's order: neighbours are far apart in the run.
    int order = ((((x ^ y) & 1) * 2 + (y & 1)) * 4) + (((x ^ y) >> 1) & 1) * 2 + ((y >> 1) & 1);
    uvec4 bits = sampleNumbers[k];
    for (int place = order * count, i = 0; place > 0; place >>= 1, ++i)
        if ((place & 1) != 0) bits ^= placeNumbers[i];
    return vec4(bits >> 8) * exp2(-24.0);
}

// The four numbers in [0,1) of sample `k` of a pixel.
vec4 sampleNumbersOf(int k, int rank) {
    return vec4((sampleNumbers[k] ^ ranks[rank]) >> 8) * exp2(-24.0);
}
