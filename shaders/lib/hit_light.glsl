// What a surface reflects sharply, at the hit of a ray: the PHATexel of the neighbourhood that the reflected direction
// leads to. source: Hensley et al. 2003: the paper's structure, at the second bounce. The search is the lookup's first
// try, and takes what it finds.
#include "lib/sharpness.glsl"

// A point whose reflected light is looked up.
struct HitLookup {
    vec3 position;
    ChartExtent chart;
    ivec2 texel;
    LookupTile tile;
    DepthProbe probe;
};

HitLookup hitLookup(vec3 position, vec2 at, uint chartIndex) {
    ChartExtent chart = chartExtent(chartIndex);
    ivec2 texel = texelInChart(chart, at, at);
    LookupTile tile = lookupTileAt(chart, texel);
    return HitLookup(position, chart, texel, tile, depthProbeAt(tile, texel, position));
}

// The radiance of a PHATexel of `layer` toward `direction`; negative where there is none.
// twin: sampleAtCursor in lib/lookup.glsl, which checks where the PHATexel's light comes from.
vec3 phatexelToward(inout HitLookup at, vec3 direction, int layer) {
    LookupTile tile = at.tile;
    float distance = distanceAlong(at.probe, direction, vec2(0.0));
    int bits = groupBits(at.chart.texelMeters, distance);
    ivec2 corner = groupCorner(tile, at.texel, bits);
    vec3 center = positionOnPatch(tile.tilePatch, vec2(corner) + 0.5 * float(1 << bits) - tile.middle);
    vec3 directionBlock = normalize(at.position + direction * distance - center) * tile.tilePatch.worldFromBlock;
    if (directionBlock.z <= 0.0) return vec3(-1.0);
    vec2 scaled = hemisphereToSquare(directionBlock) * float(kGuideSize);
    ivec2 cellAt = clamp(ivec2(scaled), 0, kGuideSize - 1);
    vec4 cell = inverseCdfCellAt(layer, tile.block, cellAt);
    vec2 square = mix(cell.xz, cell.yw, clamp(scaled - vec2(cellAt), 0.0, 1.0));
    ivec2 found = tile.blockCorner + texelHolding(square, corner - tile.blockCorner, bits, scrambleOf(tile, layer));
    if (!isInChart(at.chart, found)) return vec3(-1.0);
    Phatexel phatexel = unpackPhatexel(READ(texelFetch(phatexels, ivec3(found, layer), 0).xy));
    return phatexel.valid ? phatexel.radiance : vec3(-1.0);
}
