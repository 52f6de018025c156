// Directions of the environment by how bright they are: a row of cells by an alias table (Walker 1977), a cell of the row by
// another, a direction in it uniformly.
// twin: EnvironmentDistribution in src/core/scene/environment_sampling.h, which has cumulative tables instead;
// src/gl/environment_upload.cpp writes these.
#include "lib/environment.glsl"
#include "lib/hit_surface.glsl"
#include "lib/table.glsl"

uniform usampler2D environmentChoices;  // table: two entries a texel, of the rows, then of each row's cells
uniform ivec2 environmentCells;         // columns, rows
uniform int environmentCellTexels;      // a cell's side

const float kInfinityMeters = 1e30;

// Of `count` entries from `first` on.
int chooseEntry(int first, int count, float choice) {
    float scaled = choice * float(count);
    int own = min(int(scaled), count - 1);
    uvec4 pair = texelFetch(environmentChoices, tableTexel((first + own) >> 1), 0);
    uvec2 entry = ((first + own) & 1) == 0 ? pair.xy : pair.zw;
    return scaled - float(own) < uintBitsToFloat(entry.x) ? own : int(entry.y);
}

EmitterSample sampleEnvironment(vec4 u) {
    int row = chooseEntry(0, environmentCells.y, u.z);
    int column = chooseEntry(environmentCells.y + row * environmentCells.x, environmentCells.x, u.w);
    ivec2 size = textureSize(environment, 0), low = environmentCellTexels * ivec2(column, row);
    ivec2 high = min(low + environmentCellTexels, size);
    float height = mix(cos(kPi * float(low.y) / float(size.y)), cos(kPi * float(high.y) / float(size.y)), u.y);
    float azimuth = 2.0 * kPi * (mix(float(low.x), float(high.x), u.x) / float(size.x) + turn - 0.5);
    float across = sqrt(max(1.0 - height * height, 0.0));
    vec3 direction = vec3(across * cos(azimuth), height, across * sin(azimuth));
    return EmitterSample(direction, kInfinityMeters, environmentPdfAt(low), environmentRadiance(direction));
}
