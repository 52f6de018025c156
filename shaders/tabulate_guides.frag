// The guides of some blocks from the light in their cells, as they are read: by what draws directions, by the lookup, and
// by the pyramid.
// twin: makeGuide in src/core/phatexel/phatexture.cpp; then sumsOf in src/gl/guide_pass.cpp, inverseCdfOf in
// src/core/phatexel/lookup_tables.cpp and guidePdf in src/gl/phatexture_upload.cpp.
#include "lib/guide_direction.glsl"

uniform sampler2D cells;  // of the batch, see gather_guides.frag

layout(location = 0) out uint sumsOut;     // see lib/guide_direction.glsl
layout(location = 1) out vec4 inverseOut;  // see lib/lookup_tables.glsl
layout(location = 2) out float densityOut;

const int kGuideBits = 4;
const int kGuideCells = kGuideSize * kGuideSize;
// twin: kUniformFraction in src/core/phatexel/directions.cpp.
const float kUniformFraction = 0.3;

float lightOf(ivec2 first, int cell) {
    return texelFetch(cells, first + ivec2(cell & (kGuideSize - 1), cell >> kGuideBits), 0).x;
}

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy), cell = pixel & (kGuideSize - 1), first = pixel - cell;
    int own = cell.y * kGuideSize + cell.x, row = cell.y * kGuideSize;
    float sum = 0.0;
    for (int i = 0; i < kGuideCells; ++i) sum += lightOf(first, i);
    float scale = sum > 0.0 ? (1.0 - kUniformFraction) / sum : 0.0;
    float least = (sum > 0.0 ? kUniformFraction : 1.0) / float(kGuideCells);
    float weight = 0.0, all = 0.0, rowsBefore = 0.0, before = 0.0, rowWeight = 0.0, most = 0.0;
    int heaviest = 0;
    for (int i = 0; i < kGuideCells; ++i) {
        float w = floor((scale * lightOf(first, i) + least) * kGuideTotal);
        all += w;
        if (i < row) rowsBefore += w;
        if (i >= row && i < row + kGuideSize) rowWeight += w;
        if (i >= row && i < own) before += w;
        if (i == own) weight = w;
        if (w > most) {
            most = w;
            heaviest = i;
        }
    }
    // What rounding leaves.
    float rest = kGuideTotal - all;
    if (heaviest < row) rowsBefore += rest;
    if (heaviest >= row && heaviest < row + kGuideSize) rowWeight += rest;
    if (heaviest >= row && heaviest < own) before += rest;
    if (heaviest == own) weight += rest;
    sumsOut = uint(rowsBefore) << 16 | uint(before);
    inverseOut = vec4(vec2(before, before + weight) / rowWeight, vec2(rowsBefore, rowsBefore + rowWeight) / kGuideTotal);
    densityOut = weight * float(kGuideCells) / (2.0 * kPi * kGuideTotal);
}
