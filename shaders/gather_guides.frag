// The mean luminance that the PHATexels of some blocks have met in each cell of their guides, over 3x3 cells.
// They take the place of the photons of buildGuide in src/core/phatexel/directions.cpp: both are in proportion to radiance.
#include "lib/brdf.glsl"
#include "lib/guide_direction.glsl"
#include "lib/texel_batch.glsl"

uniform usampler2DArray phatexels;
uniform sampler2D lastCells;    // of all guides, as the output
uniform int layer;              // of the PHATexels
uniform int firstGuide;

layout(location = 0) out vec2 cellOut;  // mean; rounds that it is of

const int kGuideBits = 4;

// Over the weight of the cell, which its directions are as dense as: the sum of luminances, the number of PHATexels.
vec2 sumsOfCell(BatchBlock b, ivec2 corner, ivec2 cell) {
    float weight = cellWeight(corner, cell);
    vec4 part = partOfSquare(corner, cell) * float(kBlockSize);
    ivec2 first = ivec2(part.xy), last = min(ivec2(ceil(part.zw)), kBlockSize) - 1;
    vec2 sums = vec2(0.0);
    for (int y = first.y; y <= last.y; ++y) {
        for (int x = first.x; x <= last.x; ++x) {
            vec2 square = (vec2(x, y) + 0.5) / float(kBlockSize);
            ivec2 inBlock = texelHolding(square, ivec2(0), kBlockBits, b.scramble);
            if (any(greaterThanEqual(inBlock, b.size))) continue;
            Phatexel phatexel = unpackPhatexel(texelFetch(phatexels, ivec3(b.origin + inBlock, layer), 0).xy);
            if (phatexel.valid && guideCell(phatexel.directionBlock) == cell)
                sums += vec2(luminance(phatexel.radiance), 1.0) / weight;
        }
    }
    return sums;
}

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy), cell = pixel & (kGuideSize - 1);
    BatchBlock b = batchBlockAt(pixel >> kGuideBits);
    cellOut = vec2(0.0);
    if (b.size.x == 0) return;
    ivec2 corner = guideCorner(firstGuide + b.block);
    vec2 before = texelFetch(lastCells, corner + cell, 0).xy, sums = vec2(0.0);
    for (int i = 0; i < 9; ++i)
        sums += sumsOfCell(b, corner, clamp(cell + ivec2(i % 3, i / 3) - 1, 0, kGuideSize - 1));
    // Texels below whose horizon all of these are say nothing.
    if (sums.y == 0.0) {
        cellOut = before;
        return;
    }
    float rounds = min(before.y, b.maxSamples) + 1.0;
    cellOut = vec2(mix(before.x, sums.x / sums.y, 1.0 / rounds), rounds);
}
