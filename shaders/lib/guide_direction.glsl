// A block's guide, and directions drawn from it.
// twin: squareToGuide in src/core/phatexel/phatexture.cpp; tests/gl compares the two.
#include "lib/hemisphere_map.glsl"
#include "lib/phatexel.glsl"

// 16x16 a guide, side by side: the weights in the row before the cell; << 16: those of the rows before.
uniform usampler2D guideSums;

const float kGuideTotal = 65536.0;

ivec2 guideCorner(int guide) {
    int wide = textureSize(guideSums, 0).x / kGuideSize;
    return ivec2(guide % wide, guide / wide) * kGuideSize;
}

float rowsBefore(ivec2 corner, int row) {
    return row == kGuideSize ? kGuideTotal : float(texelFetch(guideSums, corner + ivec2(0, row), 0).x >> 16);
}

float cellsBefore(ivec2 corner, ivec2 cell) {
    return float(texelFetch(guideSums, corner + cell, 0).x & 0xffffu);
}

float rowWeight(ivec2 corner, int row) {
    return rowsBefore(corner, row + 1) - rowsBefore(corner, row);
}

float cellWeight(ivec2 corner, ivec2 cell) {
    float end = cell.x == kGuideSize - 1 ? rowWeight(corner, cell.y) : cellsBefore(corner, cell + ivec2(1, 0));
    return end - cellsBefore(corner, cell);
}

// The part of the unit square that a cell has: its corners.
vec4 partOfSquare(ivec2 corner, ivec2 cell) {
    float row = rowWeight(corner, cell.y), u = cellsBefore(corner, cell), v = rowsBefore(corner, cell.y);
    return vec4(u / row, v / kGuideTotal, (u + cellWeight(corner, cell)) / row, (v + row) / kGuideTotal);
}

// In the block's frame.
vec3 squareToGuide(int guide, vec2 square) {
    ivec2 corner = guideCorner(guide), cell = ivec2(0);
    float v = square.y * kGuideTotal;
    for (int step = kGuideSize / 2; step > 0; step >>= 1)
        if (rowsBefore(corner, cell.y + step) <= v) cell.y += step;
    float before = rowsBefore(corner, cell.y), row = rowWeight(corner, cell.y), u = square.x * row;
    for (int step = kGuideSize / 2; step > 0; step >>= 1)
        if (cellsBefore(corner, cell + ivec2(step, 0)) <= u) cell.x += step;
    vec2 within = vec2((u - cellsBefore(corner, cell)) / cellWeight(corner, cell), (v - before) / row);
    return squareToHemisphere((vec2(cell) + clamp(within, 0.0, 0.9999999)) / float(kGuideSize));
}
