// The surface point of a texel.
// twin: src/gl/texel_points.cpp.
#include "lib/atlas.glsl"
#include "lib/octahedral.glsl"
#include "lib/table.glsl"

// Of the scene at rest.
uniform usampler2D texelPoints;   // position, flat normal (octahedral); position NaN: none
uniform usampler2D texelNormals;  // interpolated normal, octahedral; kNoIrradiance: the texel has none of its own;
                                  // kCovered: inside of something, or pressed against it
uniform sampler2D chartPoses;     // table: the rows of a chart's world-from-rest matrix

const uint kNoIrradiance = 0x80008000u;
const uint kCovered = 0x80008001u;

struct TexelPoint {
    bool valid;
    bool receives;    // irradiance of its own; of others it is their neighbours'
    vec3 position;    // world
    vec3 flatNormal;  // on the chart's side
    vec3 normal;
};

TexelPoint texelPointAt(ivec2 texel) {
    uvec4 bits = texelFetch(texelPoints, texel, 0);
    vec3 rest = uintBitsToFloat(bits.xyz);
    uint normal = texelFetch(texelNormals, texel, 0).x;
    bool valid = (bits.x & 0x7fffffffu) <= 0x7f800000u && normal != kCovered;  // not every device's isnan() knows a NaN
    if (!valid) return TexelPoint(false, false, vec3(0.0), vec3(0.0, 0.0, 1.0), vec3(0.0, 0.0, 1.0));
    int row = 3 * int(chartAt(texel));
    vec4 x = texelFetch(chartPoses, tableTexel(row), 0), y = texelFetch(chartPoses, tableTexel(row + 1), 0),
         z = texelFetch(chartPoses, tableTexel(row + 2), 0);
    mat3 turn = transpose(mat3(x.xyz, y.xyz, z.xyz));  // rigid
    bool receives = normal != kNoIrradiance;
    vec3 flatNormal = turn * octahedralToDirection(unpackSnorm2x16(bits.w));
    return TexelPoint(true, receives, turn * rest + vec3(x.w, y.w, z.w), flatNormal,
                      receives ? turn * octahedralToDirection(unpackSnorm2x16(normal)) : flatNormal);
}
