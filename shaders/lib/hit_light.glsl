// What a surface reflects sharply, at the hit of a ray: the PHATexel of the neighbourhood that the reflected direction
// leads to. source: Hensley et al. 2003: the paper's structure, at the second bounce. The search is the lookup's first
// try, and takes what it finds.
#include "lib/sharpness.glsl"

// Of groups that are searched by direction alone, 2^bits texels a side. twin: kNearBits in lib/lookup.glsl.
const int kAloneBits = 3;

// A point whose reflected light is looked up.
struct HitLookup {
    vec3 position;
    ChartExtent chart;
    ivec2 texel;
    LookupTile tile;
    DepthProbe probe;
    bool seesSky;  // whether the PHATexel that was read last looks past everything
};

HitLookup hitLookup(vec3 position, vec2 at, uint chartIndex) {
    ChartExtent chart = chartExtent(chartIndex);
    ivec2 texel = texelInChart(chart, at, at);
    LookupTile tile = lookupTileAt(chart, texel);
    return HitLookup(position, chart, texel, tile, depthProbeAt(tile, texel, position), false);
}

// PHATexels that are read for a direction, of neighbouring groups.
#ifdef TEXELS
const int kGroups = 4;
#else
const int kGroups = 1;
#endif

// A PHATexel of the group at `corner` toward `direction` (world): its radiance, and the inverse of its density; none: zeros.
vec4 phatexelOfGroup(inout HitLookup at, vec3 direction, ivec2 corner, int bits, int layer) {
    LookupTile tile = at.tile;
    vec3 directionBlock = direction * tile.tilePatch.worldFromBlock;
    if (directionBlock.z <= 0.0) return vec4(0.0);
    vec2 scaled = hemisphereToSquare(directionBlock) * float(kGuideSize);
    ivec2 cellAt = clamp(ivec2(scaled), 0, kGuideSize - 1);
    vec4 cell = inverseCdfCellAt(layer, tile.block, cellAt);
    vec2 square = mix(cell.xz, cell.yw, clamp(scaled - vec2(cellAt), 0.0, 1.0));
    ivec2 found = tile.blockCorner + texelHolding(square, corner - tile.blockCorner, bits, scrambleOf(tile, layer));
    if (!isInChart(at.chart, found)) return vec4(0.0);
    Phatexel phatexel = unpackPhatexel(READ(texelFetch(phatexels, ivec3(found, layer), 0).xy));
    if (!phatexel.valid) return vec4(0.0);
    at.seesSky = phatexel.distance >= kFarDistance;
    if (kGroups == 1) return vec4(phatexel.radiance, 1.0);
    float density = cellDensity(inverseCdfCellAt(layer, tile.block, guideCell(phatexel.directionBlock)));
    return vec4(phatexel.radiance, 1.0 / max(density, kMinDensity));
}

// The radiance of PHATexels of `layer` toward `direction`; negative where there are none. A PHATexel may look anywhere in
// the cell that it is found by, where it is as dense as light is bright: if one alone stood for the cell, a lamp that fills
// a part of it would shine from all of it. The mean of several over their densities is that over the cell's solid angle.
// At contacts a group may be beyond what is near: then the direction alone says which PHATexel.
// twin: sampleAtCursor in lib/lookup.glsl, which checks where the PHATexel's light comes from.
vec3 phatexelToward(inout HitLookup at, vec3 direction, int layer) {
    float distance = distanceAlong(at.probe, direction, vec2(0.0));
    int bits = groupBits(at.chart.texelMeters, distance), side = 1 << bits;
    ivec2 corner = groupCorner(at.tile, at.texel, bits);
    // Toward the middle of the block.
    ivec2 inward = side * (1 - 2 * ivec2(greaterThanEqual(2 * (corner - at.tile.blockCorner), ivec2(kBlockSize))));
    int groups = bits == kBlockBits ? 1 : kGroups;
    vec4 sum = vec4(0.0);
    for (int i = 0; i <= groups; ++i) {
        ivec2 other = corner + inward * ivec2(i & 1, i >> 1);
        vec3 center = positionOnPatch(at.tile.tilePatch, vec2(other) + 0.5 * float(side) - at.tile.middle);
        vec3 toward = normalize(at.position + direction * distance - center);
        if (i == groups) {
            if (sum.a > 0.0) break;
            toward = direction;
            bits = kAloneBits;
            other = groupCorner(at.tile, at.texel, bits);
        }
        vec4 found = phatexelOfGroup(at, toward, other, bits, layer);
        sum += found.a * vec4(found.rgb, 1.0);
    }
    return sum.a > 0.0 ? sum.rgb / sum.a : vec3(-1.0);
}
