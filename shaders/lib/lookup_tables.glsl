// Input of the lookup: charts, tiles, depth probes, and the inverse CDFs of the guides.
// twin of the tables: src/core/phatexel/lookup_tables.h, src/core/phatexel/depth_probes.h, src/gl/lookup_pass.cpp.
#include "lib/atlas.glsl"
#include "lib/block_layout.glsl"
#include "lib/fetch.glsl"
#include "lib/phatexel.glsl"
#include "lib/table.glsl"
#include "lib/tile_patch.glsl"

uniform usampler2D charts;          // see GpuAtlas::charts
uniform usampler2D tilePatches;     // see lib/tile_patch.glsl
uniform usampler2DArray phatexels;  // [layer][y][x] packed, 8 bytes; the area lights' layer is the last
uniform sampler2D inverseCdfs;      // a guide: uLow, uHigh, vLow, vHigh of each cell; the area lights' are the last
uniform usampler2D probes;          // [4 tileY][2 tileX]: 8x4 levels of distance, 4 bits each
uniform int guideCount;             // of the indirect light
uniform int layerCount;             // of the indirect light
#ifdef AREA
uniform int areaGuideCount;
#endif
#ifdef SCRAMBLES
uniform usampler2D scrambles;       // [block row][layer][block], where there is more than one layer
#endif

const int kProbeSize = 16;
// Tables of 16x16 a guide stand so many side by side.
const int kTablesWide = 512;
// In units of length. Beyond the horizon, parallax between eye and block is neglected.
const float kHorizon = 1e4;
const float kNear = 0.01;

struct ChartExtent {
    ivec2 origin;  // texels
    ivec2 size;
    int firstBlock;
    float texelMeters;
};

ChartExtent chartExtent(uint chart) {
    uvec4 bits = READ(texelFetch(charts, tableTexel(int(chart)), 0));
    ivec2 origin = ivec2(bits.x & 0xffffu, bits.x >> 16) * 8;
    ivec2 size = ivec2(bits.y & 0xffffu, bits.y >> 16) * 8;
    return ChartExtent(origin, size, int(bits.z), uintBitsToFloat(bits.w));
}

int blockOf(ChartExtent chart, ivec2 texel) {
    ivec2 block = (texel - chart.origin) >> kBlockBits;
    int blocksWide = (chart.size.x + kBlockSize - 1) >> kBlockBits;
    return chart.firstBlock + block.y * blocksWide + block.x;
}

// A tile and its position in its block.
struct LookupTile {
    TilePatch tilePatch;
    int block;
    ivec2 blockCorner;  // texels
    vec2 middle;
};

LookupTile lookupTileAt(ChartExtent chart, ivec2 texel) {
    LookupTile t;
    ivec2 tile = texel >> 3;
    t.tilePatch = tilePatchAt(tilePatches, tile, chart.texelMeters);
    t.block = blockOf(chart, texel);
    t.blockCorner = chart.origin + (((texel - chart.origin) >> kBlockBits) << kBlockBits);
    t.middle = vec2(8 * tile + 4);
    return t;
}

// The corner of the group of 2^bits texels a side that `texel` is in.
ivec2 groupCorner(LookupTile tile, ivec2 texel, int bits) {
    return tile.blockCorner + (((texel - tile.blockCorner) >> bits) << bits);
}

// `aside`: in cells.
ivec2 hemisphereCell(vec3 direction, int size, vec2 aside) {
    vec3 d = normalize(vec3(direction.xy, max(direction.z, 0.0)));
    return clamp(ivec2(floor(hemisphereToSquare(d) * float(size) + aside)), 0, size - 1);
}

// Distances around the receiver's tile, from one of its texels; the last read is kept.
struct DepthProbe {
    ivec2 corner;      // in `probes`
    vec2 range;        // metres
    vec3 offset;       // from the receiver to that texel, world
    mat3 worldFromBlock;
    ivec2 group;
    uvec4 levels;
};

DepthProbe depthProbeAt(LookupTile tile, ivec2 texel, vec3 position) {
    vec2 fromMiddle = vec2(tile.tilePatch.probeTexel) - 3.5;
    vec3 offset = tile.tilePatch.empty ? vec3(0.0) : positionOnPatch(tile.tilePatch, fromMiddle) - position;
    ivec2 corner = (texel >> 3) * ivec2(2, 4);
    return DepthProbe(corner, tile.tilePatch.probeRange, offset, tile.tilePatch.worldFromBlock, ivec2(-1), uvec4(0u));
}

// twin: probeDistance in src/core/phatexel/depth_probes.h.
float levelDistance(vec2 range, uint level) {
    return level == 15u ? kFarDistance : range.x * pow(range.y / range.x, float(level) / 14.0);
}

uint probeLevel(inout DepthProbe probe, ivec2 cell) {
    ivec2 group = ivec2(cell.x >> 3, cell.y >> 2);
    if (group != probe.group) {
        probe.levels = READ(texelFetch(probes, probe.corner + group, 0));
        probe.group = group;
    }
    return (probe.levels[cell.y & 3] >> uint(4 * (cell.x & 7))) & 15u;
}

float distanceOf(DepthProbe probe, uint level, vec3 direction) {
    return clamp(levelDistance(probe.range, level) + dot(probe.offset, direction), kNear * unitMeters,
                 kHorizon * unitMeters);
}

// Metres from the receiver to the surface along a unit direction, or `aside` of it by so many cells of the probe.
float distanceAlong(inout DepthProbe probe, vec3 direction, vec2 aside) {
    ivec2 cell = hemisphereCell(direction * probe.worldFromBlock, kProbeSize, aside);
    return distanceOf(probe, probeLevel(probe, cell), direction);
}

// The least of the cell's that a direction is in and the eight around.
float leastDistanceAround(inout DepthProbe probe, vec3 direction) {
    ivec2 middle = hemisphereCell(direction * probe.worldFromBlock, kProbeSize, vec2(0.0));
    uint least = 15u;
    for (int i = 0; i < 9; ++i) {
        ivec2 cell = clamp(middle + ivec2(i % 3 - 1, i / 3 - 1), 0, kProbeSize - 1);
        least = min(least, probeLevel(probe, cell));
    }
    return distanceOf(probe, least, direction);
}

vec4 inverseCdfCellAt(int layer, int block, ivec2 cell) {
    int guide = guideCount == 1 ? 0 : block;
#ifdef AREA
    if (layer == layerCount) guide = guideCount + (areaGuideCount == 1 ? 0 : block);
#endif
    return READ(texelFetch(inverseCdfs, ivec2(guide % kTablesWide, guide / kTablesWide) * kGuideSize + cell, 0));
}

// 1/sr: guides are mixed with so much of the uniform density, and a cell of 8 bits may have none.
// twin: kUniformFraction in src/core/phatexel/directions.cpp.
const float kMinDensity = 0.3 / (2.0 * kPi);

// 1/sr: the density that the block's directions were sampled with. `cell`: of the inverse CDF.
float cellDensity(vec4 cell) {
    return (cell.y - cell.x) * (cell.w - cell.z) * float(kGuideSize * kGuideSize) / (2.0 * kPi);
}

// The permutation of the block's layer, see texelHolding.
uint scrambleOf(LookupTile tile, int layer) {
#ifdef SCRAMBLES
#ifdef AREA
    int layers = layerCount + 1;
#else
    int layers = layerCount;
#endif
    ivec2 entry = ivec2(tile.block % kTablesWide, (tile.block / kTablesWide) * layers + layer);
    if (layer > 0) return READ(texelFetch(scrambles, entry, 0).r);
#endif
    return tile.tilePatch.scramble;
}

// The last blocks of a chart are cut off where it ends: a group of their texels may reach beyond.
bool isInChart(ChartExtent chart, ivec2 texel) {
    return all(greaterThanEqual(texel, chart.origin)) && all(lessThan(texel, chart.origin + chart.size));
}

// The texel of the chart at `point`, in texels; beyond the chart's edge, mirrored at `around` while that is inside.
ivec2 texelInChart(ChartExtent chart, vec2 point, vec2 around) {
    vec2 low = vec2(chart.origin), high = low + vec2(chart.size);
    if (any(lessThan(point, low)) || any(greaterThanEqual(point, high))) point = 2.0 * around - point;
    return clamp(ivec2(floor(point)), chart.origin, chart.origin + chart.size - 1);
}

// The texel at which pixel `rank` of a group of 4x4 begins: the group is spread over a tile around `point`, so that
// pixels between two tiles read both.
ivec2 texelOfRank(ChartExtent chart, vec2 point, int rank) {
    vec2 within = (vec2(rank & 3, rank >> 2) - 1.5) * (float(kTileSize) / 4.0);
    return texelInChart(chart, point + within, point);
}
