// Depth probes of some blocks' tiles from the distances around them: the levels or, with RANGE, the tile patches, which
// hold between what they are.
// twin: roundToLevels in src/core/phatexel/depth_probes.cpp, packTile in src/core/phatexel/tile_patch.cpp.
#include "lib/probe_codes.glsl"

uniform usampler2D distanceCodes;  // see trace_probes.frag
#ifdef RANGE
uniform usampler2D tilePatches;
#endif

layout(location = 0) out uvec4 wordsOut;

const uint kFarthestLevel = 14u;
const uint kFarLevel = 15u;
const uint kRangeBits = 63u;

uint codeAt(BatchTile t, ivec2 cell) {
    return texelFetch(distanceCodes, t.corner + cell, 0).x;
}

// Quarters of the codes of levels 0 and 14.
uvec2 rangeOf(BatchTile t) {
    uvec2 range = uvec2(kFarDistanceCode, 0u);
    for (int cell = 0; cell < kProbeCells * kProbeCells; ++cell) {
        uint code = codeAt(t, ivec2(cell % kProbeCells, cell / kProbeCells));
        if (code != kFarDistanceCode) range = uvec2(min(range.x, code / 4u), max(range.y, (code + 3u) / 4u));
    }
    return uvec2(min(range.x, range.y), range.y);
}

#ifdef RANGE
const ivec2 kTexels = ivec2(2, 1);

uvec4 wordsOf(BatchTile t) {
    uvec4 words = texelFetch(tilePatches, t.tile * kTexels + t.inTile, 0);
    if (t.inTile.x > 0) return words;
    uvec2 range = rangeOf(t) & kRangeBits;
    words.w = (words.w & ~((kRangeBits << 19u) | (kRangeBits << 25u))) | (range.x << 19u) | (range.y << 25u);
    return words;
}
#else
const ivec2 kTexels = ivec2(2, 4);  // of 8x4 levels

uvec4 wordsOf(BatchTile t) {
    uvec2 range = rangeOf(t);
    // Codes are logarithms of distances.
    float low = float(max(4u * range.x, 1u)), extent = max(float(min(4u * range.y, 254u)) - low, 1e-6);
    uvec4 words = uvec4(0u);
    for (int i = 0; i < 32; ++i) {
        ivec2 within = ivec2(i & 7, i >> 3);
        uint code = codeAt(t, t.inTile * ivec2(8, 4) + within);
        uint level = uint(clamp((float(code) - low) / extent, 0.0, 1.0) * float(kFarthestLevel) + 0.5);
        words[within.y] |= (code == kFarDistanceCode ? kFarLevel : level) << uint(4 * within.x);
    }
    return words;
}
#endif

void main() {
    wordsOut = uvec4(0u);
    BatchTile t = batchTileAt(ivec2(gl_FragCoord.xy), kTexels);
    if (t.valid) wordsOut = wordsOf(t);
}
