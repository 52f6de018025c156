// The mean luminance that the PHATexels of some blocks have met in each cell of their guides, over 3x3 cells.
// They take the place of the photons of buildGuide in src/core/phatexel/directions.cpp: both are in proportion to radiance.
#include "lib/brdf.glsl"
#include "lib/guide_direction.glsl"
#include "lib/texel_batch.glsl"

uniform usampler2DArray phatexels;
uniform sampler2D lastCells;    // of all guides, as the output
uniform int layer;              // of the PHATexels
uniform int firstGuide;

// Mean; rounds that it is of; sums over the cell alone of luminances over the weight, and of their squares.
layout(location = 0) out vec4 cellOut;

const int kGuideBits = 4;

// Over the weight of the cell, which its directions are as dense as: the sum of luminances, the number of PHATexels; and
// the sum of the squares of the first.
vec3 sumsOfCell(BatchBlock b, ivec2 corner, ivec2 cell) {
    float weight = cellWeight(corner, cell);
    vec4 part = partOfSquare(corner, cell) * float(kBlockSize);
    ivec2 first = ivec2(part.xy), last = min(ivec2(ceil(part.zw)), kBlockSize) - 1;
    vec3 sums = vec3(0.0);
    for (int y = first.y; y <= last.y; ++y) {
        for (int x = first.x; x <= last.x; ++x) {
            vec2 square = (vec2(x, y) + 0.5) / float(kBlockSize);
            ivec2 inBlock = texelHolding(square, ivec2(0), kBlockBits, b.scramble);
            if (any(greaterThanEqual(inBlock, b.size))) continue;
            Phatexel phatexel = unpackPhatexel(texelFetch(phatexels, ivec3(b.origin + inBlock, layer), 0).xy);
            if (!phatexel.valid || guideCell(phatexel.directionBlock) != cell) continue;
            float light = luminance(phatexel.radiance) / weight;
            sums += vec3(light, 1.0 / weight, light * light);
        }
    }
    return sums;
}

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy), cell = pixel & (kGuideSize - 1);
    BatchBlock b = batchBlockAt(pixel >> kGuideBits);
    cellOut = vec4(0.0);
    if (b.size.x == 0) return;
    ivec2 corner = guideCorner(firstGuide + b.block);
    vec2 before = texelFetch(lastCells, corner + cell, 0).xy;
    vec3 sums = vec3(0.0), own = vec3(0.0);
    for (int i = 0; i < 9; ++i) {
        vec3 there = sumsOfCell(b, corner, clamp(cell + ivec2(i % 3, i / 3) - 1, 0, kGuideSize - 1));
        sums += there;
        if (i == 4) own = there;
    }
    // Texels below whose horizon all of these are say nothing.
    if (sums.y == 0.0) {
        cellOut = vec4(before, 0.0, 0.0);
        return;
    }
    float rounds = min(before.y, b.maxSamples) + 1.0;
    cellOut = vec4(mix(before.x, sums.x / sums.y, 1.0 / rounds), rounds, own.xz);
}
