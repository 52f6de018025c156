// Where a tile's texels are, and the frame of its block.
// twin: src/core/phatexel/tile_patch.h.
#include "lib/fetch.glsl"
#include "lib/frame.glsl"
#include "lib/phatexel.glsl"

struct TilePatch {
    vec3 center;    // world
    vec3 alongX;    // metres a texel
    vec3 alongY;
    vec3 bend;      // metres a squared texel
    mat3 worldFromBlock;
    uint scramble;  // of layer 0
    int groupBits;
    ivec2 probeTexel;
    vec2 probeRange;  // metres, see DepthProbe
    bool empty;
};

// Two's complement of ten and of eight bits, at `shift`.
int signed10(uint bits, int shift) {
    return int(bits << uint(22 - shift)) >> 22;
}
int signed8(uint bits, int shift) {
    return int(bits << uint(24 - shift)) >> 24;
}

vec3 axisFromBits(uint bits) {
    return vec3(ivec3(signed10(bits, 0), signed10(bits, 10), signed10(bits, 20))) / 511.0;
}

TilePatch unpackTile(uvec4 a, uvec4 b, float texelMeters) {
    TilePatch t;
    t.center = uintBitsToFloat(a.xyz);
    t.scramble = a.w & 1023u;
    t.groupBits = 3 + int((a.w >> 10) & 3u);
    t.probeTexel = ivec2((a.w >> 12) & 7u, (a.w >> 15) & 7u);
    t.empty = ((a.w >> 18) & 1u) == 0u;
    uvec2 codes = clamp(4u * uvec2((a.w >> 19) & 63u, (a.w >> 25) & 63u), 1u, 254u);
    t.probeRange = vec2(unpackDistance(codes.x), unpackDistance(codes.y));
    vec3 normal = unpackOctahedral24(b.x & 0xffffffu);
    float angle = float(b.y & 0xfffu) * (2.0 * kPi / 4096.0);
    mat3 frame = frameFromNormal(normal);
    vec3 tangent = cos(angle) * frame[0] + sin(angle) * frame[1];
    t.worldFromBlock = mat3(tangent, cross(normal, tangent), normal);
    t.alongX = texelMeters * (t.worldFromBlock * (vec3(1.0, 0.0, 0.0) + axisFromBits(b.z)));
    t.alongY = texelMeters * (t.worldFromBlock * (vec3(0.0, 1.0, 0.0) + axisFromBits(b.w)));
    t.bend = texelMeters / (127.0 * 16.0) * vec3(ivec3(signed8(b.x, 24), signed8(b.y, 12), signed8(b.y, 20)));
    return t;
}

// pre: the tile has a chart.
TilePatch tilePatchAt(usampler2D tilePatches, ivec2 tile, float texelMeters) {
    ivec2 at = ivec2(2 * tile.x, tile.y);
    return unpackTile(READ(texelFetch(tilePatches, at, 0)), READ(texelFetch(tilePatches, at + ivec2(1, 0), 0)),
                      texelMeters);
}

// World; `fromMiddle` in texels.
vec3 positionOnPatch(TilePatch t, vec2 fromMiddle) {
    vec3 squares = vec3(fromMiddle.x * fromMiddle.x, fromMiddle.x * fromMiddle.y, fromMiddle.y * fromMiddle.y);
    return t.center + fromMiddle.x * t.alongX + fromMiddle.y * t.alongY +
           dot(t.bend, squares) * t.worldFromBlock[2];
}
